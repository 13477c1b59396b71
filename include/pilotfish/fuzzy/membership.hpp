#pragma once

#include <array>
#include <variant>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::fuzzy {

/// mu(x) = max(0, min((x - a)/(b - a), (c - x)/(c - b))), with a <= b <= c and a < c. A vertical side is
/// allowed (a == b): the peak itself then has degree 1.
struct Triangle {
  /// Left end, top, right end.
  double a, b, c;
};
/// mu(x) = max(0, min((x - a)/(b - a), 1, (d - x)/(d - c))), with a <= b <= c <= d and a < d. An open
/// shoulder has a == b == -inf (everything to the left belongs) or c == d == +inf.
struct Trapezoid {
  /// Left end, top from b to c, right end.
  double a, b, c, d;
};
/// mu(x) = exp(-(x - mean)^2 / (2 sigma^2)), with sigma > 0.
struct Gaussian {
  /// Its top, and its width.
  double mean, sigma;
};

using MembershipFunction = std::variant<Triangle, Trapezoid, Gaussian>;

double membership(const Triangle& set, double x) noexcept;
double membership(const Trapezoid& set, double x) noexcept;
double membership(const Gaussian& set, double x) noexcept;
/// Degree of membership in [0, 1]; NaN for NaN.
double membership(const MembershipFunction& set, double x) noexcept;

/// The level cut {x : mu(x) >= level}, a closed interval; level in (0, 1]. Every set here is convex, so the
/// cut is one interval, and its ends are the breakpoints of the set clipped at `level`.
std::array<double, 2> level_cut(const MembershipFunction& set, double level) noexcept;

/// Closed interval outside of which the degree is zero (infinite for Gaussians and open shoulders).
std::array<double, 2> support(const MembershipFunction& set) noexcept;

/// Throws std::invalid_argument in the words of the formulas above ("a <= b <= c is violated: 1, 0, 2").
void validate(const MembershipFunction& set);

}  // namespace pilotfish::fuzzy
PILOTFISH_API_END
