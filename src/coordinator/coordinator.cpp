#include "pilotfish/coordinator/coordinator.hpp"

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

}  // namespace

const std::vector<Parameter<SafetyConfig>>& SafetyConfig::parameters() {
  static const std::vector<Parameter<SafetyConfig>> table = {
      {"max_age_s", &SafetyConfig::max_age_s, 0.0, 0.1, "a measurement older than this moves nothing"},
  };
  return table;
}

Coordinator::Coordinator(const CoordinatorConfig& config)
    : observer_(config.camera, config.mounting, config.leader, config.vision),
      follower_(config.control),
      setpoint_(config.setpoint) {
  check_ranges(config.safety, "safety");
  check_ranges(config.setpoint, "setpoint");
  max_age_us_ = static_cast<std::int64_t>(config.safety.max_age_s * 1e6);
}

StepResult Coordinator::step(const Frame& frame) noexcept {
  // A frame from the past, or one seen before, says nothing about now; it must not rewind the clock of the age limit.
  if (last_frame_utime_ && frame.utime <= *last_frame_utime_)
    return not_measured(*last_frame_utime_, Reason::frame_time_not_advancing);
  last_frame_utime_ = frame.utime;

  // Between the last measurement and this frame the wheels were told to stand still: the law starts from rest.
  if (!fresh_at(frame.utime)) rest();

  const vision::Sight sight = observer_.observe(frame);
  if (!setpoint_.run) {
    rest();
    StepResult result{frame.utime, Status::stopped, Reason::told_to_stop, sight.observation, std::nullopt, Twist{}};
    return result;
  }
  if (!sight.observation) return not_measured(frame.utime, sight.reason);

  const control::FollowerOutput control = follower_.follow(*sight.observation, setpoint_);
  if (!is_finite(control.command)) {
    rest();
    return not_measured(frame.utime, Reason::law_not_finite);
  }
  ever_measured_ = true;
  last_measured_utime_ = frame.utime;
  last_command_ = control.command;
  return {frame.utime, Status::tracking, Reason::none, sight.observation, control, control.command};
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
  const std::int64_t age_us = utime - *last_measured_utime_;
  return age_us >= 0 && age_us <= max_age_us_;  // a measurement from the future is not to be trusted either
}

void Coordinator::rest() noexcept {
  last_measured_utime_.reset();
  last_command_ = Twist{};
  follower_.restart();
}

bool Coordinator::set_setpoint(const Setpoint& setpoint) noexcept {
  try {
    check_ranges(setpoint, "setpoint");
  } catch (const std::exception&) {
    return false;
  }
  setpoint_ = setpoint;
  if (!setpoint.run) rest();
  return true;
}

}  // namespace pilotfish
