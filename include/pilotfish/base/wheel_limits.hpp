#pragma once

#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/base/diff_drive.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::base {

/// What the wheels are allowed, whoever asks. Meant a little wider than the coordinator's own limits, so that the
/// two agree and these act only when something is wrong.
struct WheelLimitsConfig {
  double max_linear_mps = 0.7;
  double max_reverse_mps = 0.7;
  double max_linear_acceleration_mps2 = 1.5;
  double brake_mps2 = 3.0;
  double max_angular_radps = 2.5;
  double max_angular_acceleration_radps2 = 20.0;
  double max_wheel_radps = 40.0;
  static const std::vector<Parameter<WheelLimitsConfig>>& parameters();
};

/// `wanted`, as near as the limits allow, a time dt_s after `told`. Never NaN: what is not finite is a zero. An exact
/// zero is passed on at once, whatever `told` was: standing still is never put off. A slower speed that is not zero is
/// reached with brake_mps2. Where a wheel would turn too fast, both are slowed down alike, which keeps the curvature.
Twist limit(const WheelLimitsConfig& limits, const DriveGeometry& geometry, const Twist& wanted, const Twist& told,
            double dt_s) noexcept;

}  // namespace pilotfish::base
PILOTFISH_API_END
