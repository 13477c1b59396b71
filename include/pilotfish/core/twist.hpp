#pragma once

#include <cmath>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// Velocity of a unicycle in its own base frame: forward speed and turn rate (positive: to the left).
struct Twist {
  double linear_mps = 0.0;     ///< forward speed [m/s], in the robot's base frame
  double angular_radps = 0.0;  ///< turn rate [rad/s], positive: to the left
};

inline bool is_finite(const Twist& twist) {
  return std::isfinite(twist.linear_mps) && std::isfinite(twist.angular_radps);
}

inline bool operator==(const Twist& a, const Twist& b) {
  return a.linear_mps == b.linear_mps && a.angular_radps == b.angular_radps;
}

}  // namespace pilotfish
PILOTFISH_API_END
