#include "pilotfish/fuzzy/centroid.hpp"

#include <cmath>

#include "envelope.hpp"
#include "layers.hpp"

namespace pilotfish::fuzzy {
namespace {

// A line from (x0, y0) to (x1, y1):  int y dx = w (y0 + y1)/2  and  int x y dx = w/6 (x0 (2 y0 + y1) + x1 (y0
// + 2 y1)) with w = x1 - x0 (Simpson's rule, exact for the quadratic x y).
Moments line_moments(const Arc& line, double x0, double x1) noexcept {
  const double y0 = line(x0), y1 = line(x1), width = x1 - x0;
  return {0.5 * width * (y0 + y1), width / 6.0 * (x0 * (2.0 * y0 + y1) + x1 * (y0 + 2.0 * y1))};
}

// A Gaussian g:  int g dx = sigma sqrt(pi/2) [erf(z)] with z = (x - m)/(sigma sqrt 2), and because g' = -(x -
// m)/sigma^2 g, int x g dx = m int g dx - sigma^2 [g]. An arc lies on one side of the mean, where differences
// of erfc keep the digits that differences of erf lose in the tails.
Moments gaussian_moments(const Arc& gaussian, double x0, double x1) noexcept {
  constexpr double kSqrtHalfPi = 1.25331413731550025121, kSqrtHalf = 0.70710678118654752440;
  const double z0 = (x0 - gaussian.mean) / gaussian.sigma * kSqrtHalf,
               z1 = (x1 - gaussian.mean) / gaussian.sigma * kSqrtHalf;
  const double erf_difference = z0 >= 0.0 ? std::erfc(z0) - std::erfc(z1) : std::erfc(-z1) - std::erfc(-z0);
  const double area = gaussian.sigma * kSqrtHalfPi * erf_difference;
  return {area, gaussian.mean * area - gaussian.sigma * gaussian.sigma * (gaussian(x1) - gaussian(x0))};
}

}  // namespace

Moments clipped_union_moments(const LinguisticVariable& output, const double* term_strengths) noexcept {
  Moments sum;
  Envelope(output, term_strengths).for_each([&](double begin, double end, const Arc& arc) {
    const Moments piece = arc.is_gaussian() ? gaussian_moments(arc, begin, end) : line_moments(arc, begin, end);
    sum.area += piece.area;
    sum.first += piece.first;
  });
  return sum;
}

std::optional<Moments> ordered_union_moments(const LinguisticVariable& output, const double* term_strengths) {
  if (!OrderedUnion::fits(output)) return std::nullopt;
  const OrderedUnion ordered(output);
  return ordered.moments(ordered.sum_over(std::vector<bool>(output.terms.size(), true)), term_strengths);
}

}  // namespace pilotfish::fuzzy
