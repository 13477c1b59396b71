#pragma once

#include <cmath>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

inline constexpr double kPi = 3.14159265358979323846;

constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }
constexpr double degrees(double radians) { return radians * (180.0 / kPi); }

/// The same angle in (-pi, pi]. NaN stays NaN, for the caller's check to find.
inline double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);  // in [-pi, pi]
  return wrapped <= -kPi ? wrapped + 2.0 * kPi : wrapped;
}

}  // namespace pilotfish
PILOTFISH_API_END
