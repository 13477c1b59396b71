#include <algorithm>
#include <cmath>

#include "pilotfish/fuzzy/input_width.hpp"
#include "with_shape.hpp"

namespace pilotfish::fuzzy {
namespace {

// A' falls on either side of x and a term falls on either side of its core, so the sup of their minimum lies between x
// and the core, where they meet. If x is left of the core, the term's rising side counts: from `foot` (degree 0) to
// `core` (degree 1). The other case is its mirror image, so there are only rising sides here.

// Triangle A', straight side: 1 - (t - x)/w = (t - foot)/(core - foot) at the degree (x + w - foot)/(w + core - foot).
double meet_straight(double x, double w, double foot, double core) noexcept {
  const double reach = x + w - foot;
  return reach > 0.0 ? reach / (w + core - foot) : 0.0;
}

// The degree where A', falling from 1 at x, and a side that rises to 1 at `core` meet: they cross once between x and
// core, and 64 halvings end at adjacent doubles.
template <class Falling, class Rising>
double meet(double x, double core, Falling falling, Rising rising) noexcept {
  double low = x, high = core;
  for (int i = 0; i < 64; ++i) {
    const double middle = 0.5 * (low + high);
    if (!(low < middle && middle < high)) break;
    (falling(middle) > rising(middle) ? low : high) = middle;
  }
  // Both bound the degree from opposite sides, at low and at high.
  return std::max(std::min(falling(low), rising(low)), std::min(falling(high), rising(high)));
}

double rising_side(const Trapezoid& s, double x, double w, WidthShape shape) noexcept {
  if (shape == WidthShape::triangle) return meet_straight(x, w, s.a, s.b);
  const Gaussian input{x, w};
  if (!(s.a < s.b)) return membership(input, s.b);
  return meet(
      x, s.b, [&](double t) { return membership(input, t); },
      [&](double t) { return std::max((t - s.a) / (s.b - s.a), 0.0); });
}

// Two bells meet between their means where both are as many sigmas away: after (mean - x)/(sigma + w).
double rising_side(const Gaussian& s, double x, double w, WidthShape shape) noexcept {
  if (shape == WidthShape::gaussian) return membership(Gaussian{s.mean, s.sigma + w}, x);
  return meet(
      x, s.mean, [&](double t) { return std::max(1.0 - (t - x) / w, 0.0); },
      [&](double t) { return membership(s, t); });
}

double of(const Gaussian& s, const LinguisticVariable& variable, double x, double w, WidthShape shape) noexcept {
  if (x == s.mean) return 1.0;
  // Right of the mean: turn the axis round.
  const double at = x < s.mean ? x : -x, mean = x < s.mean ? s.mean : -s.mean;
  // Where the mean is outside the universe, the crossing may be as well: then the end of the universe is the best
  // point.
  const double end = x < s.mean ? variable.max : variable.min;
  const bool inside = variable.min <= s.mean && s.mean <= variable.max;
  const double met = rising_side(Gaussian{mean, s.sigma}, at, w, shape);
  return inside ? met : std::min(met, membership(s, end));
}

double of(const Trapezoid& s, const LinguisticVariable& variable, double x, double w, WidthShape shape) noexcept {
  if (s.b <= x && x <= s.c) return 1.0;
  const bool left = x < s.b;
  const double met = left ? rising_side(s, x, w, shape) : rising_side(Trapezoid{-s.d, -s.c, -s.b, -s.a}, -x, w, shape);
  const double end = left ? variable.max : variable.min;
  const bool inside = left ? s.b <= variable.max : s.c >= variable.min;
  return inside ? met : std::min(met, membership(s, end));
}

double of(const Triangle& s, const LinguisticVariable& variable, double x, double w, WidthShape shape) noexcept {
  return of(Trapezoid{s.a, s.b, s.b, s.c}, variable, x, w, shape);
}

}  // namespace

double possibility(const LinguisticVariable& variable, const MembershipFunction& term, double x, double width,
                   WidthShape shape) noexcept {
  if (!(width > 0.0)) return membership(term, x);
  return with_shape(term, [&](const auto& set) { return of(set, variable, x, width, shape); });
}

}  // namespace pilotfish::fuzzy
