#pragma once

#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/base/diff_drive.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::base {

/// Limits of the wheels, for every sender. To be set a little wider than the coordinator's own limits, so that
/// these act only when something is wrong.
struct WheelLimitsConfig {
  PILOTFISH_PARAMETERS(WheelLimitsConfig);
  PILOTFISH_PARAMETER(double, max_linear_mps, 0.7, 0.01, 5.0, "forward speed");
  PILOTFISH_PARAMETER(double, max_reverse_mps, 0.7, 0.0, 5.0, "speed allowed backwards; 0 forbids reversing");
  PILOTFISH_PARAMETER(double, max_linear_acceleration_mps2, 1.5, 0.01, 20.0, "speeding up");
  PILOTFISH_PARAMETER(double, brake_mps2, 3.0, 0.01, 100.0,
                      "slowing down to a speed that is not zero; zero itself is passed on at once");
  PILOTFISH_PARAMETER(double, max_angular_radps, 2.5, 0.01, 20.0, "turn rate");
  PILOTFISH_PARAMETER(double, max_angular_acceleration_radps2, 20.0, 0.01, 200.0, "change of turn rate");
  PILOTFISH_PARAMETER(double, max_wheel_radps, 40.0, 0.1, 1000.0,
                      "of each wheel; where one would be faster, both are slowed down alike");
};

/// `wanted`, as near as the limits allow, a time dt_s after `last`. Never NaN: what is not finite is a zero. An exact
/// zero is passed on at once, whatever `last` was: a stop is never delayed. A slower speed that is not zero is
/// reached with brake_mps2. Where a wheel would turn too fast, both are slowed down alike, which keeps the curvature.
Twist limit(const WheelLimitsConfig& limits, const DriveGeometry& geometry, const Twist& wanted, const Twist& last,
            double dt_s) noexcept;

}  // namespace pilotfish::base
PILOTFISH_API_END
