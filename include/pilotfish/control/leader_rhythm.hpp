#pragma once

#include <array>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// How far a leader that swings foretells its own track: with r, r' and r'' plane vectors, equal times apart,
///
///   e = r - f r' - g r'',   (f, g) minimising sum lambda^age |e|^2 + kRidge_m2 (f^2 + g^2)
///
/// over all so far, r included. The normal equations have two unknowns: five sums are all that is remembered. The ridge
/// is some noise of r', so that noise alone is not explained. A value; nothing throws.
class LeaderRhythm {
 public:
  /// A vector of the plane.
  struct Planar {
    double x_m = 0.0;  ///< along the x-axis [m]
    double y_m = 0.0;  ///< along the y-axis [m]
  };
  /// |e|^2 after `r` = {r, r', r''} has been added with that weight, and what was before counts `keep` of what it did.
  double unexplained_m2(const std::array<Planar, 3>& r, double weight, double keep) noexcept {
    first_first_ = keep * first_first_ + weight * product(r[1], r[1]);
    first_second_ = keep * first_second_ + weight * product(r[1], r[2]);
    second_second_ = keep * second_second_ + weight * product(r[2], r[2]);
    now_first_ = keep * now_first_ + weight * product(r[0], r[1]);
    now_second_ = keep * now_second_ + weight * product(r[0], r[2]);
    const double first = first_first_ + kRidge_m2, second = second_second_ + kRidge_m2;
    const double determinant = first * second - first_second_ * first_second_;  // >= kRidge_m2^2
    const double f = (second * now_first_ - first_second_ * now_second_) / determinant;
    const double g = (first * now_second_ - first_second_ * now_first_) / determinant;
    const Planar e{r[0].x_m - f * r[1].x_m - g * r[2].x_m, r[0].y_m - f * r[1].y_m - g * r[2].y_m};
    return product(e, e);
  }

  static constexpr double kRidge_m2 = 0.0002 * 0.0002;  ///< variance of a difference that is noise [m^2]

 private:
  static double product(const Planar& a, const Planar& b) noexcept { return a.x_m * b.x_m + a.y_m * b.y_m; }

  double first_first_ = 0.0, first_second_ = 0.0, second_second_ = 0.0, now_first_ = 0.0, now_second_ = 0.0;
};

}  // namespace pilotfish::control
PILOTFISH_API_END
