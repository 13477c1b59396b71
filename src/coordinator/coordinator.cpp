#include "pilotfish/coordinator/coordinator.hpp"

#include <algorithm>
#include <cmath>

#include "configured.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/utime.hpp"

namespace pilotfish {
namespace {

// While an alternative is followed, the whole picture is searched for the first leader so often, until it is found.
constexpr double kLookAgain_s = 0.5;

constexpr double kRangesFromFrame_us = 0.5e6;  // a scan that is farther from the last frame is of another clock

bool is_invalid(Reason reason) { return kReasons[static_cast<std::size_t>(reason)].kind == ReasonKind::input; }

bool is_too_near(const Setpoint& setpoint, double stop_distance_m) { return setpoint.distance_m < stop_distance_m; }

}  // namespace

Coordinator::Coordinator(const CoordinatorConfig& config)
    : max_age_us_(static_cast<std::int64_t>(config.safety.max_age_s * 1e6)),
      stop_distance_m_(config.safety.stop_distance_m),
      noiseless_camera_(config.safety.noiseless_camera),
      timeline_(max_age_us_),
      observers_(observers_of(config)),
      follower_(with_view(config)),
      setpoints_(setpoints_of(config)),
      choice_(config.alternatives, observers_.size(), config.safety.max_age_s),
      goes_back_(config.alternatives.back_after_s > 0.0),
      nearest_m_(std::max(config.control.guard.minimum_distance_m, config.safety.stop_distance_m)),
      farthest_m_(config.vision.acquisition_range_m),
      seen_(observers_.size()) {
  check(config, observers_);
  held_.run = config.setpoint.run;
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
  observe(frame);
  compare_leaders();
  return step_latest(frame.utime, verdict.age_us);
}

void Coordinator::clear_seen() noexcept {
  for (vision::ObservationResult& seen : seen_) seen = {std::nullopt, Reason::no_tag_found, {}};
}

/// A picture that was shown before is no new measurement: it must not lengthen the life of the last one, whatever its
/// stamp.
void Coordinator::observe(const Frame& frame) noexcept {
  clear_seen();
  vision::ObservationResult& seen = seen_[leader_index()];
  if (!noiseless_camera_ && check(frame.image) == Reason::none) {
    switch (frozen_.compare(frame.image)) {
      case Repetition::none: break;
      case Repetition::probable: seen.reason = Reason::picture_repeated; return;
      case Repetition::certain: seen.reason = Reason::camera_frozen; return;
    }
  }
  seen = observers_[leader_index()].observe(frame);
  if (observers_.size() > 1 && setpoint().run && held_.ever_measured) look_for_others(frame);
}

/// While the followed leader is in view nobody else is looked for, but for the first one, to return to it.
void Coordinator::look_for_others(const Frame& frame) noexcept {
  static const vision::Detections kNothing;
  const std::size_t followed = leader_index();
  if (!seen_[followed].observation) {
    const vision::Detections* found = observers_[followed].searched();
    if (found == nullptr) return;  // the picture is of no use
    for (std::size_t i = 0; i < observers_.size(); ++i)
      if (i != followed) seen_[i] = observers_[i].observe_detected(frame, *found);
  } else if (followed != 0 && goes_back_) {
    if (observers_.front().tracks_at(frame.utime)) {
      seen_.front() = observers_.front().observe_detected(frame, kNothing);
    } else if (!looked_utime_ || seconds_between(*looked_utime_, frame.utime) >= kLookAgain_s) {
      looked_utime_ = frame.utime;
      seen_.front() = observers_.front().observe(frame);
    }
  }
}

bool Coordinator::can_follow(const vision::ObservationResult& seen) const noexcept {
  return seen.observation && seen.observation->distance_m >= nearest_m_ &&
         seen.observation->distance_m <= farthest_m_ && std::abs(seen.observation->bearing_rad) <= kMaxBearing_rad;
}

bool Coordinator::another_is_seen() const noexcept {
  for (std::size_t i = 0; i < seen_.size(); ++i)
    if (i != leader_index() && in_view_[i]) return true;
  return false;
}

void Coordinator::compare_leaders() noexcept {
  in_view_ = {};
  for (std::size_t i = 0; i < seen_.size(); ++i)
    in_view_[i] = i == leader_index() ? seen_[i].observation.has_value() : can_follow(seen_[i]);
}

bool Coordinator::change_leader(std::int64_t utime) noexcept {
  if (observers_.size() == 1) return false;
  if (!held_.ever_measured && !in_view_[leader_index()]) return false;  // nobody has been lost yet
  if (!choice_.update(utime, in_view_)) return false;
  looked_utime_.reset();
  follower_.change_leader();
  return true;
}

StepResult Coordinator::step_observation(std::int64_t utime, const vision::ObservationResult& seen, MonotonicTime now,
                                         std::int64_t known_age_us) noexcept {
  const StampVerdict verdict = classify(utime, known_age_us, now);
  if (verdict.reason != Reason::none) return not_measured(utime, verdict.reason);
  clear_seen();
  seen_[leader_index()] = seen;
  compare_leaders();
  return step_latest(utime, verdict.age_us);
}

StepResult Coordinator::step_recorded(std::int64_t utime, const vision::ObservationResult& seen,
                                      const LeadersSeen& in_view, MonotonicTime now,
                                      std::int64_t known_age_us) noexcept {
  const StampVerdict verdict = classify(utime, known_age_us, now);
  if (verdict.reason != Reason::none) return not_measured(utime, verdict.reason);
  std::fill(seen_.begin(), seen_.end(),
            seen);  // whoever is followed after this frame: of the others only in_view_ counts
  in_view_ = in_view;
  return step_latest(utime, verdict.age_us);
}

StepResult Coordinator::step_observations(std::int64_t utime, const std::vector<vision::ObservationResult>& seen,
                                          MonotonicTime now, std::int64_t known_age_us) noexcept {
  const StampVerdict verdict = classify(utime, known_age_us, now);
  if (verdict.reason != Reason::none) return not_measured(utime, verdict.reason);
  clear_seen();
  std::copy_n(seen.begin(), std::min(seen.size(), seen_.size()), seen_.begin());
  compare_leaders();
  return step_latest(utime, verdict.age_us);
}

StepResult Coordinator::with_leader(StepResult result) const noexcept {
  result.leader_index = static_cast<std::int64_t>(leader_index());
  result.leader_changes = leader_changes();
  return result;
}

StepResult Coordinator::step_latest(std::int64_t utime, std::int64_t age_us) noexcept {
  if (!setpoint().run) {
    rest(utime);
    choice_.restart();
    return with_leader(
        {utime, Status::stopped, Reason::stop_requested, seen_[leader_index()].observation, std::nullopt, Twist{}, {}});
  }
  const bool changed = change_leader(utime);
  const vision::ObservationResult& seen = seen_[leader_index()];
  if (!seen.observation) {
    if (seen.reason == Reason::camera_frozen) rest(utime);  // the last measurement may be as old as the picture
    if (const std::optional<StepResult> turn = search(utime, age_us, seen.reason)) return *turn;
    if (choice_.is_lost() && !is_invalid(seen.reason) && another_is_seen())
      return not_measured(utime, Reason::checking_another_leader);
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

  const control::FollowerOutput control = follower_.follow(*seen.observation, setpoint());
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
  return with_leader({utime,
                      Status::tracking,
                      changed   ? Reason::leader_changed
                      : blocked ? Reason::obstacle_in_path
                                : Reason::none,
                      seen.observation,
                      control,
                      control.command,
                      {}});
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
  return with_leader({utime, Status::lost, search.reason, std::nullopt, std::nullopt, turn, {}});
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
  return with_leader({held_.utime, answer.status, answer.reason, std::nullopt, std::nullopt, answer.command, {}});
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
  for (vision::LeaderObserver& observer : observers_) observer.forget();
  choice_.restart();
  looked_utime_.reset();
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
  if (usable) setpoints_[leader_index()] = setpoint;
  for (Setpoint& each : setpoints_) each.run = setpoint.run;
  held_.run = setpoint.run;
  if (!setpoint.run) rest(held_.utime);
  return true;
}

template <class Self, class Archive>
void Coordinator::remember_decisions(Self& self, Archive& archive) {
  archive(self.timeline_, self.follower_, self.choice_, self.looked_utime_, self.now_, self.measured_utime_, self.held_,
          self.ranges_at_);
  for (auto& setpoint : self.setpoints_) archive(setpoint.distance_m, setpoint.bearing_rad, setpoint.run);
}

template <class Self, class Archive>
void Coordinator::remember_vision(Self& self, Archive& archive) {
  archive(self.frozen_);
  for (auto& observer : self.observers_) archive(observer);
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

vision::RejectionCounters Coordinator::rejected() const noexcept {
  vision::RejectionCounters sum;
  for (const vision::LeaderObserver& observer : observers_) sum = sum_of(sum, observer.rejected());
  return sum;
}

std::int64_t Coordinator::whole_picture_searches() const noexcept {
  std::int64_t sum = 0;
  for (const vision::LeaderObserver& observer : observers_) sum += observer.whole_picture_searches();
  return sum;
}

void Coordinator::time_stages(vision::StageStopwatch::Clock clock) noexcept {
  for (vision::LeaderObserver& observer : observers_) observer.time_stages(clock);
}

bool Coordinator::is_near_last_frame(std::int64_t utime) const noexcept {
  const std::optional<std::int64_t> last = timeline_.last_utime();
  return last && std::abs(seconds_between(*last, utime)) <= kOtherClock_s;
}

bool Coordinator::set_ego_motion(std::int64_t utime, const Twist& twist) noexcept {
  return is_near_last_frame(utime) && follower_.set_ego_motion(utime, twist);
}

bool Coordinator::set_leader_intent(std::int64_t utime, const Twist& twist) noexcept {
  return leader_index() == 0 && is_near_last_frame(utime) && follower_.set_leader_intent(utime, twist);
}

}  // namespace pilotfish
