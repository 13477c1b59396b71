#include "pilotfish/coordinator/coordinator.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/utime.hpp"
#include "pilotfish/vision/nearest_visible.hpp"

namespace pilotfish {
namespace {

/// Bearings of the left and the right edge of the picture, at half its height. The camera's place on the robot does not
/// matter at the distances at which a leader is followed.
control::FieldOfView field_of_view(const CameraModel& camera, const CameraMounting& mounting) {
  const auto bearing = [&](double u) {
    const Eigen::Vector2d xy = normalize_pixel(camera, {u, (camera.height - 1) / 2.0});
    const Eigen::Vector3d ray = base_from_camera(mounting).linear() * Eigen::Vector3d(xy.x(), xy.y(), 1.0);
    return std::atan2(ray.y(), ray.x());
  };
  // An edge lies less than half a turn from the middle; a camera that is mounted upside down has them exchanged.
  const double middle = bearing(camera.cx);
  const auto edge = [&](double u) {
    const double bearing_rad = bearing(u), from_middle = bearing_rad - middle;
    return std::abs(from_middle) <= kPi ? bearing_rad : bearing_rad - std::copysign(2.0 * kPi, from_middle);
  };
  const auto [right_rad, left_rad] = std::minmax({edge(camera.width - 0.5), edge(-0.5)});
  return {right_rad, left_rad};
}

/// With a camera whose view contains none of the allowed bearings the robot could never drive.
void check_view(const control::FieldOfView& view) {
  if (view.left_rad > -kMaxBearing_rad && view.right_rad < kMaxBearing_rad) return;
  std::ostringstream problem;
  problem << "the camera sees bearings from " << degrees(view.right_rad) << " to " << degrees(view.left_rad)
          << " deg only; a leader is followed at -" << degrees(kMaxBearing_rad) << " to " << degrees(kMaxBearing_rad)
          << " deg, ahead of the robot";
  throw ConfigError("camera.mounting.pan_deg", problem.str());
}

control::FollowerConfig with_view(const CoordinatorConfig& config) {
  control::FollowerConfig control = config.control;
  control.view = field_of_view(config.camera, config.mounting);
  check_view(control.view);
  control.hold_s = config.safety.max_age_s;
  return control;
}

void check_blind_travel(const CoordinatorConfig& config) {
  const double max_age_s = config.safety.max_age_s;
  const double top_mps = std::max(config.control.limits.max_linear_mps, config.control.limits.max_reverse_mps);
  if (max_age_s <= kOrdinaryMaxAge_s || max_age_s * top_mps <= kMaxBlindTravel_m * (1.0 + 1e-9)) return;
  std::ostringstream problem;
  problem << max_age_s << " s at " << top_mps << " m/s is " << max_age_s * top_mps << " m of blind travel, more than "
          << kMaxBlindTravel_m << " m; lower control.limits.max_linear_mps and max_reverse_mps to "
          << kMaxBlindTravel_m / max_age_s << ", or max_age_s to " << kOrdinaryMaxAge_s;
  throw ConfigError("safety.max_age_s", problem.str());
}

/// The leader must still be visible at the guard distance: otherwise the robot stops, without sight of it, before
/// the guard acts, or is hit.
void check_guard(const CoordinatorConfig& config, const vision::TagTracker& tracker) {
  const double guard_m = config.control.guard.minimum_distance_m;
  const double nearest_m = vision::nearest_visible_distance_m(tracker, config.mounting);
  if (nearest_m <= guard_m) return;
  std::ostringstream problem;
  problem << guard_m << " m is nearer than " << nearest_m
          << " m, the nearest distance at which this camera, where it is "
          << "mounted, can see a tag of this leader; allowed: " << nearest_m
          << " to 20 m, or mount the camera and the tags "
          << "farther apart or at more nearly the same height";
  throw ConfigError("control.guard.minimum_distance_m", problem.str());
}

constexpr double kRangesFromFrame_us = 0.5e6;  // a scan that is farther from the last frame is of another clock

bool is_invalid(Reason reason) { return kReasons[static_cast<std::size_t>(reason)].kind == ReasonKind::input; }

bool is_too_near(const Setpoint& setpoint, double stop_distance_m) { return setpoint.distance_m < stop_distance_m; }

}  // namespace

Coordinator::Coordinator(const CoordinatorConfig& config)
    : max_age_us_(static_cast<std::int64_t>(config.safety.max_age_s * 1e6)),
      stop_distance_m_(config.safety.stop_distance_m),
      noiseless_camera_(config.safety.noiseless_camera),
      timeline_(max_age_us_),
      observer_(config.camera, config.mounting, config.leader, config.vision),
      follower_(with_view(config)),
      setpoint_(config.setpoint) {
  check_ranges(config.safety, "safety");
  check_ranges(config.setpoint, "setpoint");
  check_blind_travel(config);
  check_guard(config, observer_.tracker());
  if (is_too_near(config.setpoint, stop_distance_m_)) {
    std::ostringstream problem;
    problem << config.setpoint.distance_m << " is below safety.stop_distance_m (" << stop_distance_m_ << ")";
    throw ConfigError("setpoint.distance_m", problem.str());
  }
  held_.run = setpoint_.run;
  needs_ranges_ = config.control.avoidance.enabled;
  max_ranges_age_us_ = static_cast<std::int64_t>(config.control.avoidance.max_age_s * 1e6);
}

StampVerdict Coordinator::classify(std::int64_t utime, std::int64_t known_age_us, MonotonicTime now) noexcept {
  now_ = std::max(now_, now);
  const StampVerdict verdict = timeline_.classify(utime, known_age_us, now_);
  if (verdict.new_epoch) begin_epoch();
  held_.utime = timeline_.last_utime().value_or(0);
  // Between the last measurement and this frame the command was zero.
  if (verdict.reason == Reason::none && !held_.fresh_at(now_)) pause();
  return verdict;
}

StepResult Coordinator::step(const Frame& frame, MonotonicTime now) noexcept {
  const StampVerdict verdict = classify(frame.utime, frame.known_age_us, now);
  if (verdict.reason != Reason::none) return not_measured(frame.utime, verdict.reason);
  return step_latest(frame.utime, observe(frame), verdict.age_us);
}

/// A picture that was shown before is no new measurement: it must not lengthen the life of the last one, whatever its
/// stamp.
vision::ObservationResult Coordinator::observe(const Frame& frame) noexcept {
  if (!noiseless_camera_ && check(frame.image) == Reason::none) {
    switch (frozen_.compare(frame.image)) {
      case Repetition::none: break;
      case Repetition::probable: return {std::nullopt, Reason::picture_repeated, {}};
      case Repetition::certain: return {std::nullopt, Reason::camera_frozen, {}};
    }
  }
  return observer_.observe(frame);
}

StepResult Coordinator::step_observation(std::int64_t utime, const vision::ObservationResult& seen, MonotonicTime now,
                                         std::int64_t known_age_us) noexcept {
  const StampVerdict verdict = classify(utime, known_age_us, now);
  if (verdict.reason != Reason::none) return not_measured(utime, verdict.reason);
  return step_latest(utime, seen, verdict.age_us);
}

StepResult Coordinator::step_latest(std::int64_t utime, const vision::ObservationResult& seen,
                                    std::int64_t age_us) noexcept {
  if (!setpoint_.run) {
    rest(utime);
    return {utime, Status::stopped, Reason::stop_requested, seen.observation, std::nullopt, Twist{}, {}};
  }
  if (!seen.observation) {
    if (seen.reason == Reason::camera_frozen) rest(utime);  // the last measurement may be as old as the picture
    if (const std::optional<StepResult> turn = search(utime, age_us, seen.reason)) return *turn;
    StepResult result = not_measured(utime, seen.reason);
    result.refused = seen.refused;
    return result;
  }
  if (needs_ranges_ && !ranges_fresh_at(now_)) {
    stop_now();
    StepResult result = not_measured(utime, Reason::ranges_not_fresh);
    result.observation = seen.observation;
    return result;
  }

  const control::FollowerOutput control = follower_.follow(*seen.observation, setpoint_);
  if (control.reason != Reason::none) {
    rest(utime);
    StepResult result = not_measured(utime, control.reason);
    result.observation = seen.observation;  // so that a recording has the input on which the law failed
    return result;
  }
  measured_utime_ = utime;
  held_.ever_measured = true;
  hold(control.command, age_us, false);
  const bool blocked = control.avoidance && ((control.avoidance->limited && control.command.linear_mps == 0.0) ||
                                             control.avoidance->backing_off);
  return {utime,
          Status::tracking,
          blocked ? Reason::obstacle_in_path : Reason::none,
          seen.observation,
          control,
          control.command,
          {}};
}

void Coordinator::hold(const Twist& command, std::int64_t age_us, bool turning) noexcept {
  held_.command = command;
  held_.from = now_;
  held_.until = {later(now_.us, max_age_us_ - age_us)};
  if (needs_ranges_) held_.until = std::min(held_.until, MonotonicTime{later(ranges_at_->us, max_ranges_age_us_)});
  held_.holding = true;
  held_.turning = turning;
}

bool Coordinator::ranges_fresh_at(MonotonicTime now) const noexcept {
  return ranges_at_ && now <= MonotonicTime{later(ranges_at_->us, max_ranges_age_us_)};
}

/// The measurement's last command has run out, and what is missing is the leader, not the picture.
std::optional<StepResult> Coordinator::search(std::int64_t utime, std::int64_t age_us, Reason reason) noexcept {
  const bool picture = reason != Reason::camera_frozen && reason != Reason::picture_repeated && !is_invalid(reason);
  if (!needs_ranges_ || !picture || !held_.ever_measured || !ranges_fresh_at(now_)) return std::nullopt;
  if (held_.fresh_at(now_) && !held_.turning) return std::nullopt;
  const control::SearchOutput search = follower_.search(utime);
  if (!search.turning) {
    held_.holding = held_.turning = false;
    held_.command = Twist{};
    return std::nullopt;
  }
  const Twist turn{0.0, search.angular_radps};
  hold(turn, age_us, true);
  return StepResult{utime, Status::lost, search.reason, std::nullopt, std::nullopt, turn, {}};
}

bool Coordinator::set_ranges(const RangeScan& scan, MonotonicTime now) noexcept {
  const std::optional<std::int64_t> last = timeline_.last_utime();
  if (!needs_ranges_ || !last || std::abs(seconds_between(*last, scan.utime)) * 1e6 > kRangesFromFrame_us) return false;
  if (!follower_.set_ranges(scan)) return false;
  ranges_at_ = now;
  return true;
}

StepResult Coordinator::command_at(MonotonicTime now, Reason reason) const noexcept {
  const HeldAnswer answer = held_.at(now, reason);
  return {held_.utime, answer.status, answer.reason, std::nullopt, std::nullopt, answer.command, {}};
}

StepResult Coordinator::not_measured(std::int64_t utime, Reason reason) const noexcept {
  StepResult result = command_at(now_, reason);
  result.utime = utime;
  return result;
}

/// What was held ends at this instant, and not when it would have.
void Coordinator::stop_now() noexcept {
  held_.until = std::min(held_.until, now_);
  pause();
}

void Coordinator::pause() noexcept {
  if (held_.holding) follower_.pause(held_.until.us - held_.from.us);
  held_.holding = held_.turning = false;
  held_.command = Twist{};
}

void Coordinator::rest(std::int64_t since_utime) noexcept {
  held_.holding = held_.turning = false;
  held_.command = Twist{};
  follower_.restart(since_utime);
}

void Coordinator::begin_epoch() noexcept {
  held_.holding = held_.turning = false;
  ranges_at_.reset();
  held_.command = Twist{};
  observer_.forget();
  follower_.restart_on_new_clock();
}

bool Coordinator::set_setpoint(const Setpoint& setpoint) noexcept {
  bool usable = !is_too_near(setpoint, stop_distance_m_);
  try {
    check_ranges(setpoint, "setpoint");
  } catch (const std::exception&) {
    usable = false;
  }
  if (!usable && setpoint.run) return false;
  if (usable) setpoint_ = setpoint;
  setpoint_.run = held_.run = setpoint.run;
  if (!setpoint.run) rest(held_.utime);
  return true;
}

template <class Self, class Archive>
void Coordinator::remember_decisions(Self& self, Archive& archive) {
  archive(self.timeline_, self.follower_, self.setpoint_.distance_m, self.setpoint_.bearing_rad, self.setpoint_.run,
          self.now_, self.measured_utime_, self.held_, self.ranges_at_);
}

template <class Self, class Archive>
void Coordinator::remember_vision(Self& self, Archive& archive) {
  archive(self.frozen_, self.observer_);
}

CoordinatorMemory Coordinator::memory() const {
  CoordinatorMemory memory;
  CheckpointWriter decisions(memory.decisions), vision(memory.vision);
  remember_decisions(*this, decisions);
  remember_vision(*this, vision);
  return memory;
}

bool Coordinator::set_memory(const CoordinatorMemory& memory) {
  const auto take = [this](const CoordinatorMemory& from) {
    CheckpointReader decisions(from.decisions), vision(from.vision);
    remember_decisions(*this, decisions);
    remember_vision(*this, vision);
    return decisions.read_all() && vision.read_all();
  };
  const CoordinatorMemory before = this->memory();
  if (take(memory)) return true;
  take(before);
  return false;
}

bool Coordinator::is_near_last_frame(std::int64_t utime) const noexcept {
  const std::optional<std::int64_t> last = timeline_.last_utime();
  return last && std::abs(seconds_between(*last, utime)) <= kOtherClock_s;
}

bool Coordinator::set_ego_motion(std::int64_t utime, const Twist& twist) noexcept {
  return is_near_last_frame(utime) && follower_.set_ego_motion(utime, twist);
}

bool Coordinator::set_leader_intent(std::int64_t utime, const Twist& twist) noexcept {
  return is_near_last_frame(utime) && follower_.set_leader_intent(utime, twist);
}

}  // namespace pilotfish
