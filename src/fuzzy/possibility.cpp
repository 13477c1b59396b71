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

// A degree and its slope.
struct Degree {
  double value, slope;
};
Degree gaussian(const Gaussian& set, double t) noexcept {
  const double value = membership(set, t);
  return {value, -(t - set.mean) / (set.sigma * set.sigma) * value};
}
Degree line(double foot, double core, double t) noexcept {
  return t > foot ? Degree{(t - foot) / (core - foot), 1.0 / (core - foot)} : Degree{0.0, 0.0};
}

// The degree where A', falling from 1 at `low`, and a side that rises to 1 at `high` meet: they cross once between.
// Newton's steps where they stay in the bracket and halve the gap, halvings where they do not; so it ends when the gap
// is closed to kClosed or the bracket has no more doubles in it, after kSteps at the latest.
template <class Falling, class Rising>
double meet(double low, double high, Falling falling, Rising rising) noexcept {
  constexpr double kClosed = 1e-14;
  constexpr int kSteps = 128;
  double t = 0.5 * (low + high), gap_before = 2.0, degree = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const Degree f = falling(t), r = rising(t);
    const double gap = f.value - r.value;
    degree = 0.5 * (f.value + r.value);
    (gap > 0.0 ? low : high) = t;
    if (std::abs(gap) <= kClosed || !(low < 0.5 * (low + high) && 0.5 * (low + high) < high)) break;
    t -= gap / (f.slope - r.slope);
    if (!(low < t && t < high) || std::abs(gap) > 0.5 * gap_before) t = 0.5 * (low + high);
    gap_before = std::abs(gap);
  }
  return degree;
}

double rising_side(const Trapezoid& s, double x, double w, WidthShape shape) noexcept {
  if (shape == WidthShape::triangle) return meet_straight(x, w, s.a, s.b);
  const Gaussian input{x, w};
  if (!(s.a < s.b)) return membership(input, s.b);
  return meet(
      std::max(x, s.a), s.b, [&](double t) { return gaussian(input, t); }, [&](double t) { return line(s.a, s.b, t); });
}

// Two Gaussians meet between their means where both are as many sigmas away: after (mean - x)/(sigma + w).
double rising_side(const Gaussian& s, double x, double w, WidthShape shape) noexcept {
  if (shape == WidthShape::gaussian) return membership(Gaussian{s.mean, s.sigma + w}, x);
  return meet(
      x, std::min(s.mean, x + w),
      [&](double t) {
        return Degree{1.0 - (t - x) / w, -1.0 / w};
      },
      [&](double t) { return gaussian(s, t); });
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
