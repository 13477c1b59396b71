#pragma once

#include <algorithm>
#include <cmath>

namespace pilotfish::control {

/// The forward speed [m/s] of a robot whose part along the line of sight is `radial_mps`: v cos(theta) = v_r.
///
/// If the leader is beside the robot, no speed of the robot changes the distance: there the law must not divide by
/// zero. Setpoints keep away from there (kMaxBearing_rad), so this bounds a transient only.
inline double forward_speed(double radial_mps, double bearing_rad) noexcept {
  constexpr double kMinCosine = 0.3;
  return radial_mps / std::max(std::cos(bearing_rad), kMinCosine);
}

}  // namespace pilotfish::control
