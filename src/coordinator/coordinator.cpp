#include "pilotfish/coordinator/coordinator.hpp"

#include <cmath>

#include "pilotfish/core/utime.hpp"

namespace pilotfish {
namespace {

/// Reasons that are the picture's fault rather than the leader's absence.
bool is_invalid_input(Reason reason) {
  switch (reason) {
    case Reason::frame_size_not_calibrated:
    case Reason::frame_too_small:
    case Reason::frame_too_large:
    case Reason::frame_truncated:
    case Reason::frame_stride_invalid:
    case Reason::frame_time_not_advancing:
    case Reason::frame_stale: return true;
    default: return false;
  }
}

/// Bearings of the left and the right edge of the picture, at half its height. The camera's place on the robot does not
/// matter at the distances at which a leader is followed.
control::FieldOfView field_of_view(const CameraModel& camera, const CameraMounting& mounting) {
  const auto bearing = [&](double u) {
    const Eigen::Vector2d xy = normalize_pixel(camera, {u, (camera.height - 1) / 2.0});
    const Eigen::Vector3d ray = base_from_camera(mounting).linear() * Eigen::Vector3d(xy.x(), xy.y(), 1.0);
    return std::atan2(ray.y(), ray.x());
  };
  return {bearing(camera.width - 0.5), bearing(-0.5)};
}

control::FollowerConfig with_view(const CoordinatorConfig& config) {
  control::FollowerConfig control = config.control;
  control.view = field_of_view(config.camera, config.mounting);
  return control;
}

}  // namespace

const std::vector<Parameter<SafetyConfig>>& SafetyConfig::parameters() {
  static const std::vector<Parameter<SafetyConfig>> table = {
      {"max_age_s", &SafetyConfig::max_age_s, 0.0, 0.1, "a measurement older than this moves nothing"},
  };
  return table;
}

Coordinator::Coordinator(const CoordinatorConfig& config)
    : observer_(config.camera, config.mounting, config.leader, config.vision),
      follower_(with_view(config)),
      setpoint_(config.setpoint) {
  check_ranges(config.safety, "safety");
  check_ranges(config.setpoint, "setpoint");
  max_age_us_ = static_cast<std::int64_t>(config.safety.max_age_s * 1e6);
}

StepResult Coordinator::step(const Frame& frame) noexcept {
  if (!is_newer(frame.utime)) return not_measured(*last_frame_utime_, Reason::frame_time_not_advancing);
  return answer_latest(frame.utime, observer_.observe(frame));
}

StepResult Coordinator::answer(std::int64_t utime, const vision::Sight& sight) noexcept {
  if (!is_newer(utime)) return not_measured(*last_frame_utime_, Reason::frame_time_not_advancing);
  return answer_latest(utime, sight);
}

bool Coordinator::is_newer(std::int64_t utime) noexcept {
  // A frame from the past, or one seen before, says nothing about now; it must not rewind the clock of the age limit.
  if (last_frame_utime_ && utime <= *last_frame_utime_) return false;
  last_frame_utime_ = utime;
  // Between the last measurement and this frame the wheels were told to stand still: the law starts from rest.
  if (!fresh_at(utime)) rest(later(last_measured_utime_.value_or(utime), max_age_us_));
  return true;
}

StepResult Coordinator::answer_latest(std::int64_t utime, const vision::Sight& sight) noexcept {
  if (!setpoint_.run) {
    rest(utime);
    StepResult result{utime, Status::stopped, Reason::told_to_stop, sight.observation, std::nullopt, Twist{}};
    return result;
  }
  if (!sight.observation) return not_measured(utime, sight.reason);

  const control::FollowerOutput control = follower_.follow(*sight.observation, setpoint_);
  if (!is_finite(control.command)) {
    rest(utime);
    return not_measured(utime, Reason::law_not_finite);
  }
  ever_measured_ = true;
  last_measured_utime_ = utime;
  last_command_ = control.command;
  return {utime, Status::tracking, Reason::none, sight.observation, control, control.command};
}

StepResult Coordinator::without_frame(std::int64_t utime, Reason reason) const noexcept {
  return not_measured(utime, reason);
}

StepResult Coordinator::not_measured(std::int64_t utime, Reason reason) const noexcept {
  StepResult result;
  result.utime = utime;
  result.reason = reason;
  if (!setpoint_.run) {
    result.status = Status::stopped;
    result.reason = Reason::told_to_stop;
    return result;
  }
  const bool fresh = fresh_at(utime);
  if (fresh) result.command = last_command_;
  if (is_invalid_input(reason)) {
    result.status = Status::invalid_input;
  } else if (fresh) {
    result.status = Status::coasting;
  } else {
    result.status = ever_measured_ ? Status::lost : Status::searching;
  }
  return result;
}

bool Coordinator::fresh_at(std::int64_t utime) const noexcept {
  if (!last_measured_utime_) return false;
  // As doubles: two times off a wire may be farther apart than an int64 can say; up to the year 2255 they are exact.
  const double age_us = static_cast<double>(utime) - static_cast<double>(*last_measured_utime_);
  // A measurement from the future is not to be trusted either.
  return age_us >= 0.0 && age_us <= static_cast<double>(max_age_us_);
}

void Coordinator::rest(std::int64_t since_utime) noexcept {
  last_measured_utime_.reset();
  last_command_ = Twist{};
  follower_.restart(since_utime);
}

bool Coordinator::set_setpoint(const Setpoint& setpoint) noexcept {
  try {
    check_ranges(setpoint, "setpoint");
  } catch (const std::exception&) {
    return false;
  }
  setpoint_ = setpoint;
  if (!setpoint.run) rest(last_frame_utime_.value_or(0));
  return true;
}

bool Coordinator::is_near_last_frame(std::int64_t utime) const noexcept {
  return last_frame_utime_ && std::abs(seconds_between(*last_frame_utime_, utime)) <= kOtherClock_s;
}

bool Coordinator::set_own_motion(std::int64_t utime, const Twist& twist) noexcept {
  return is_near_last_frame(utime) && follower_.set_own_motion(utime, twist);
}

bool Coordinator::set_announced_motion(std::int64_t utime, const Twist& twist) noexcept {
  return is_near_last_frame(utime) && follower_.set_announced_motion(utime, twist);
}

}  // namespace pilotfish
