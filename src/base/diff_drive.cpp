#include "pilotfish/base/diff_drive.hpp"

#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::base {
namespace {

/// Counters wrap around at 32 bits: the difference does too, and is right as long as the true one is below 2^31.
std::int32_t wrapped_difference(std::int32_t now, std::int32_t before) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(now) - static_cast<std::uint32_t>(before));
}

/// After a gap longer than this between two readings the present speed is unknown.
constexpr std::uint32_t kLongestGap_ms = 1000;
constexpr double kImplausible = 2.0;  // times the wheels' limit
constexpr double kSlackTicks = 4.0;   // a reading's own rounding, in very short intervals

}  // namespace

WheelSpeeds wheel_speeds(const DriveGeometry& geometry, const Twist& twist) noexcept {
  const double half_turn_mps = twist.angular_radps * geometry.track_width_m / 2.0;
  return {(twist.linear_mps - half_turn_mps) / geometry.wheel_radius_m,
          (twist.linear_mps + half_turn_mps) / geometry.wheel_radius_m};
}

Twist twist_of(const DriveGeometry& geometry, const WheelSpeeds& speeds) noexcept {
  return {geometry.wheel_radius_m * (speeds.right_radps + speeds.left_radps) / 2.0,
          geometry.wheel_radius_m * (speeds.right_radps - speeds.left_radps) / geometry.track_width_m};
}

WheelOdometry::WheelOdometry(const DriveGeometry& geometry, double max_wheel_radps)
    : geometry_(geometry), max_wheel_radps_(max_wheel_radps) {}

std::optional<Twist> WheelOdometry::update(const EncoderReading& reading) noexcept {
  if (!last_) {
    last_ = reading;
    return std::nullopt;
  }
  const std::uint32_t passed_ms = reading.time_ms - last_->time_ms;
  if (passed_ms == 0) return std::nullopt;
  const double left_ticks = wrapped_difference(reading.left_ticks, last_->left_ticks);
  const double right_ticks = wrapped_difference(reading.right_ticks, last_->right_ticks);
  last_ = reading;

  const double dt_s = passed_ms * 1e-3;
  const double rad_per_tick = 2.0 * kPi / geometry_.ticks_per_revolution;
  const double most_ticks = kSlackTicks + kImplausible * max_wheel_radps_ * dt_s / rad_per_tick;
  if (passed_ms > kLongestGap_ms || std::abs(left_ticks) > most_ticks || std::abs(right_ticks) > most_ticks) {
    ++jumps_;
    return std::nullopt;
  }
  // Both wheels are assumed to have turned evenly in between: then the robot went along an arc, exactly.
  const Twist twist = twist_of(geometry_, {left_ticks * rad_per_tick / dt_s, right_ticks * rad_per_tick / dt_s});
  pose_ = move_along_arc(pose_, twist, dt_s);
  return twist;
}

}  // namespace pilotfish::base
