#include "pilotfish/fuzzy/membership.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

#include "with_shape.hpp"

namespace pilotfish::fuzzy {
namespace {

// A triangle is the trapezoid whose core is one point. The comparisons come before the divisions, so that a
// vertical side (a == b) or an open shoulder (a == b == -inf) never divides.
double trapezoid_degree(double a, double b, double c, double d, double x) noexcept {
  if (std::isnan(x)) return x;
  if (x < a || x > d) return 0.0;
  if (x < b) return (x - a) / (b - a);
  if (x > c) return (d - x) / (d - c);
  return 1.0;
}

// An open shoulder (inf - inf) and a vertical side stay where they are. Clamped to the core, so that rounding
// never turns the interval round.
std::array<double, 2> trapezoid_cut(double a, double b, double c, double d, double level) noexcept {
  return {a == b ? b : std::min(a + level * (b - a), b), c == d ? c : std::max(d - level * (d - c), c)};
}

[[noreturn]] void violated(const char* condition, std::initializer_list<double> numbers) {
  std::ostringstream text;
  text << condition << " is violated: ";
  const char* separator = "";
  for (double number : numbers) {
    text << separator << number;
    separator = ", ";
  }
  throw std::invalid_argument(text.str());
}

// Written so that NaN fails: every comparison with NaN is false.
void check(const Triangle& s) {
  if (!(s.a <= s.b && s.b <= s.c)) violated("a <= b <= c", {s.a, s.b, s.c});
  if (!(s.a < s.c)) violated("a < c", {s.a, s.b, s.c});
  if (std::isinf(s.a) || std::isinf(s.c)) violated("a and c are finite", {s.a, s.b, s.c});
}

void check(const Trapezoid& s) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::initializer_list<double> numbers = {s.a, s.b, s.c, s.d};
  if (!(s.a <= s.b && s.b <= s.c && s.c <= s.d)) violated("a <= b <= c <= d", numbers);
  if (!(s.a < s.d)) violated("a < d", numbers);
  if (s.a == kInfinity || s.d == -kInfinity || s.b == kInfinity || s.c == -kInfinity)
    violated("b < +inf and c > -inf", numbers);
  if (std::isinf(s.a) && !std::isinf(s.b)) violated("a == b == -inf for an open left shoulder", numbers);
  if (std::isinf(s.d) && !std::isinf(s.c)) violated("c == d == +inf for an open right shoulder", numbers);
}

void check(const Gaussian& s) {
  if (!std::isfinite(s.mean)) violated("mean is finite", {s.mean});
  if (!(s.sigma > 0.0) || std::isinf(s.sigma)) violated("0 < sigma < inf", {s.sigma});
}

std::array<double, 2> cut(const Triangle& s, double level) noexcept { return trapezoid_cut(s.a, s.b, s.b, s.c, level); }
std::array<double, 2> cut(const Trapezoid& s, double level) noexcept {
  return trapezoid_cut(s.a, s.b, s.c, s.d, level);
}
std::array<double, 2> cut(const Gaussian& s, double level) noexcept {
  const double radius = s.sigma * std::sqrt(-2.0 * std::log(level));
  return {s.mean - radius, s.mean + radius};
}

}  // namespace

double membership(const Triangle& set, double x) noexcept { return trapezoid_degree(set.a, set.b, set.b, set.c, x); }

double membership(const Trapezoid& set, double x) noexcept { return trapezoid_degree(set.a, set.b, set.c, set.d, x); }

double membership(const Gaussian& set, double x) noexcept {
  const double z = (x - set.mean) / set.sigma;
  return std::exp(-0.5 * z * z);
}

double membership(const MembershipFunction& set, double x) noexcept {
  return with_shape(set, [x](const auto& shape) { return membership(shape, x); });
}

std::array<double, 2> level_cut(const MembershipFunction& set, double level) noexcept {
  return with_shape(set, [level](const auto& shape) { return cut(shape, level); });
}

std::array<double, 2> support(const MembershipFunction& set) noexcept { return level_cut(set, 0.0); }

void validate(const MembershipFunction& set) {
  with_shape(set, [](const auto& shape) { check(shape); });
}

}  // namespace pilotfish::fuzzy
