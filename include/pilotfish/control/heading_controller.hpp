#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// The proportional heading controller.
struct HeadingControllerConfig {
  PILOTFISH_PARAMETERS(HeadingControllerConfig);
  PILOTFISH_PARAMETER(double, gain_per_s, 2.0, 0.0, 20.0, "turn rate per radian of bearing error");
};

/// Turn rate [rad/s] that lets theta approach theta_pd. Turning left by w moves a fixed point to the right in the base
/// frame, d(theta)/dt = -w + ..., so w = gain (theta - theta_pd) makes the bearing error decay with time constant
/// 1/gain.
double heading_turn_rate(const HeadingControllerConfig& config, double bearing_rad, double bearing_setpoint_rad);

}  // namespace pilotfish::control
PILOTFISH_API_END
