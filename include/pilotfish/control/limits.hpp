#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// Limits on speed, turn rate and their change.
struct LimitsConfig {
  PILOTFISH_PARAMETERS(LimitsConfig);
  PILOTFISH_PARAMETER(double, max_linear_mps, 0.6, 0.01, 5.0, "forward speed");
  PILOTFISH_PARAMETER(double, max_reverse_mps, 0.3, 0.0, 5.0, "speed allowed backwards; 0 forbids reversing");
  PILOTFISH_PARAMETER(double, max_linear_acceleration_mps2, 1.0, 0.01, 20.0, "speeding up and braking");
  PILOTFISH_PARAMETER(double, max_angular_radps, 2.0, 0.01, 20.0, "turn rate");
  PILOTFISH_PARAMETER(double, max_angular_acceleration_radps2, 10.0, 0.01, 200.0, "change of turn rate");
};

/// The nearest command to `wanted` within the limits on speed and, starting from `previous` a time dt_s ago, on
/// acceleration. dt_s <= 0 allows no change of speed beyond the speed limits themselves. Zero if `wanted` is not
/// finite; a `previous` that is not finite counts as standstill.
Twist limit(const LimitsConfig& config, const Twist& wanted, const Twist& previous, double dt_s);

}  // namespace pilotfish::control
PILOTFISH_API_END
