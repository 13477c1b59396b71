#include "pilotfish/base/wheel_limits.hpp"

#include <algorithm>
#include <cmath>

namespace pilotfish::base {
namespace {

/// From `last` towards `wanted` in a time dt: away from zero with `up`, towards zero with `down`, and through zero with
/// `down` as long as it lasts and `up` for the rest of the time.
double approach(double wanted, double last, double up, double down, double dt) noexcept {
  const bool slowing = std::signbit(wanted) != std::signbit(last) || std::abs(wanted) < std::abs(last);
  if (!slowing || last == 0.0) return std::clamp(wanted, last - up * dt, last + up * dt);
  const double speed = std::abs(last);
  if (std::signbit(wanted) == std::signbit(last))
    return std::copysign(std::max(std::abs(wanted), speed - down * dt), last);
  const double to_zero = speed / down;
  if (to_zero >= dt) return std::copysign(speed - down * dt, last);
  return std::copysign(std::min(std::abs(wanted), up * (dt - to_zero)), wanted);
}

}  // namespace

Twist limit(const WheelLimitsConfig& limits, const DriveGeometry& geometry, const Twist& wanted, const Twist& last,
            double dt_s) noexcept {
  if (!is_finite(wanted) || wanted == Twist{}) return {};
  const double dt = std::max(dt_s, 0.0);
  const Twist allowed{std::clamp(wanted.linear_mps, -limits.max_reverse_mps, limits.max_linear_mps),
                      std::clamp(wanted.angular_radps, -limits.max_angular_radps, limits.max_angular_radps)};
  Twist limited{
      approach(allowed.linear_mps, last.linear_mps, limits.max_linear_acceleration_mps2, limits.brake_mps2, dt),
      approach(allowed.angular_radps, last.angular_radps, limits.max_angular_acceleration_radps2,
               limits.max_angular_acceleration_radps2, dt)};
  const WheelSpeeds speeds = wheel_speeds(geometry, limited);
  const double fastest = std::max(std::abs(speeds.left_radps), std::abs(speeds.right_radps));
  if (fastest > limits.max_wheel_radps) {
    const double slower = limits.max_wheel_radps / fastest;
    limited = {limited.linear_mps * slower, limited.angular_radps * slower};
  }
  return limited;
}

}  // namespace pilotfish::base
