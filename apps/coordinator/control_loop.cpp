#include "control_loop.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "latency_watch.hpp"
#include "pilotfish/core/angles.hpp"
#include "reporter.hpp"
#include "search_budget.hpp"
#include "simulated_clock.hpp"
#include "translate.hpp"

namespace pilotfish::apps {
namespace {

double seconds_between(MonotonicTime from, MonotonicTime to) { return static_cast<double>(to.us - from.us) * 1e-6; }

/// Frames per second over roughly the last ten frames.
class RateMeter {
 public:
  double arrived(MonotonicTime at) {
    if (last_) {
      const double interval_s = std::max(seconds_between(*last_, at), 1e-6);
      interval_s_ = interval_s_ > 0.0 ? 0.9 * interval_s_ + 0.1 * interval_s : interval_s;
    }
    last_ = at;
    return interval_s_ > 0.0 ? 1.0 / interval_s_ : 0.0;
  }

 private:
  std::optional<MonotonicTime> last_;
  double interval_s_ = 0.0;
};

class Loop {
 public:
  Loop(const LoopConfig& config, const LoopParts& parts, Coordinator& coordinator)
      : config_(config),
        parts_(parts),
        coordinator_(coordinator),
        reporter_(config, parts, coordinator),
        latency_(config),
        search_(config.frame_rate_hz, config.max_age_s) {}

  /// Until the end, which is reported as well: the last status must not be taken for the present one.
  void run() {
    work();
    StepResult end = coordinator_.command_at(now());
    end.status = Status::stopped;
    end.reason = Reason::stop_requested;
    end.command = Twist{};
    reporter_.report(end, timing_);
  }

 private:
  void work() {
    const std::chrono::microseconds period(static_cast<std::int64_t>(1e6 / config_.frame_rate_hz));
    const std::chrono::microseconds timeout = parts_.pull ? std::chrono::microseconds(0) : period + period / 2;
    while (!parts_.stop_requested()) {
      parts_.progress();
      Inbox::Taken taken = parts_.inbox.take(timeout);
      for (const Received& received : taken.received) std::visit([this](const auto& each) { receive(each); }, received);
      if (parts_.pull) {
        std::optional<Frame> frame = parts_.pull();
        if (!frame) return;
        process(*frame, monotonic_now());
      } else if (taken.frame) {
        if (const std::optional<Frame> frame = taken.frame->decode()) {
          if (parts_.black_box != nullptr) record_picture(*frame, *taken.frame);
          process(*frame, taken.frame->at);
        }
      } else if (taken.received.empty()) {
        reporter_.report(coordinator_.command_at(now()), timing_);  // the sender sends the command itself
      }
    }
  }

  /// For questions between frames, on the frames' clock.
  MonotonicTime now() const { return config_.simulated ? clock_.now() : monotonic_now(); }

  void process(Frame frame, MonotonicTime arrival) {
    if (config_.simulated && last_utime_ == frame.utime && !parts_.pull) {
      // The same picture again: a simulator repeats it because the answer got lost. The old one holds while it is
      // fresh.
      parts_.sender.answer_again(frame.utime);
      return;
    }
    last_utime_ = frame.utime;
    timing_.frame_rate_hz = rate_.arrived(arrival);
    reporter_.picture = frame.image;
    // A replay or a simulation waits for the answer and must not depend on the speed of this computer.
    frame.coarse_search = !config_.simulated && search_.coarse();
    const MonotonicTime begin = monotonic_now();
    const MonotonicTime now = config_.simulated ? clock_.at(frame.utime, arrival) : arrival;
    StepResult result = coordinator_.step(frame, now);
    const MonotonicTime end = monotonic_now();
    timing_.processing_s = seconds_between(begin, end);
    if (coordinator_.whole_picture_searches() != searches_) watch_search(timing_.processing_s);
    if (parts_.black_box != nullptr) parts_.black_box->frame(frame, now, result, coordinator_);
    const HeldAnswer sent = parts_.sender.answer(result, coordinator_.held(), frame.utime);
    const MonotonicTime left = monotonic_now();
    if (parts_.preview != nullptr) parts_.preview->offer(frame);
    reporter_.waited.add(seconds_between(arrival, begin));
    reporter_.looked.add(timing_.processing_s);
    reporter_.answered.add(seconds_between(arrival, left));
    count_refused(result.reason);
    result.command = sent.command;
    result.status = sent.status;
    result.reason = sent.reason;
    reporter_.summary.frame(result, seconds_between(arrival, left));
    latency_.answered(seconds_between(arrival, left), frame.known_age_us, timing_);
    count_epochs();
    reporter_.report(result, timing_);
    reporter_.print(result, timing_);
  }

  void watch_search(double seconds) {
    searches_ = coordinator_.whole_picture_searches();
    if (!search_.searched(seconds) || config_.simulated) return;
    spdlog::warn(
        "searching a whole picture took {:.0f} ms, and there are {:.0f}: three of four are searched at half the "
        "resolution, which finds a leader at half the distance only. A lower vision.acquisition_range_m, a smaller "
        "picture or a lower frame_rate_hz would make it quick enough",
        seconds * 1e3, search_.budget_s() * 1e3);
  }

  /// Of a JPEG the bytes that were decoded, so that a replay can repeat the vision; of others a copy now and then, for
  /// viewing.
  void record_picture(const Frame& frame, const PendingFrame& pending) const {
    if (pending.jpeg_message == nullptr) return parts_.black_box->picture(frame);
    parts_.black_box->message(bus::channel(config_.robot, "IMAGE"), pending.jpeg_message->data(),
                              pending.jpeg_message->size());
  }

  void receive(const ReceivedSetpoint& received) {
    const bool taken = coordinator_.set_setpoint(received.setpoint);
    if (parts_.black_box != nullptr) parts_.black_box->setpoint(received.setpoint, taken, coordinator_);
    if (!taken) {
      ++reporter_.refused["setpoint_too_near"];
      return;
    }
    reporter_.setpoint_counter = std::max(reporter_.setpoint_counter, received.counter);
    parts_.sender.setpoint_changed(coordinator_.held(), received.stops_received);
    log_setpoint();
  }

  /// A flood of them must not become a flood of lines.
  void log_setpoint() {
    const Setpoint& now = coordinator_.setpoint();
    const MonotonicTime at = monotonic_now();
    if (logged_setpoint_ && logged_setpoint_->distance_m == now.distance_m &&
        logged_setpoint_->bearing_rad == now.bearing_rad && logged_setpoint_->run == now.run)
      return;  // repeated: not logged
    if (logged_setpoint_ && seconds_between(setpoint_logged_at_, at) < kSetpointLines_s) {
      ++setpoints_not_logged_;
      return;
    }
    logged_setpoint_ = now;
    setpoint_logged_at_ = at;
    spdlog::info("setpoint: {:.2f} m at {:.1f} deg, {}{}", now.distance_m, degrees(now.bearing_rad),
                 now.run ? "run" : "stop",
                 setpoints_not_logged_ > 0 ? " (" + std::to_string(setpoints_not_logged_) + " others not shown)" : "");
    setpoints_not_logged_ = 0;
  }

  void receive(const ReceivedMotion& received) {
    const bool used = received.of_the_leader ? coordinator_.set_leader_intent(received.utime, received.twist)
                                             : coordinator_.set_ego_motion(received.utime, received.twist);
    if (parts_.black_box != nullptr) {
      if (received.of_the_leader) {
        parts_.black_box->leader_intent(received.utime, received.twist, used, coordinator_);
      } else {
        parts_.black_box->ego_motion(received.utime, received.twist, used, coordinator_);
      }
    }
    if (!used) ++reporter_.refused[received.of_the_leader ? "leader_intent_unusable" : "ego_motion_unusable"];
  }

  void receive(const ReceivedRanges& received) {
    const MonotonicTime at = config_.simulated ? clock_.now() : received.at;
    const bool used = coordinator_.set_ranges(*received.scan, at);
    if (parts_.black_box != nullptr) parts_.black_box->ranges(*received.scan, at, used, coordinator_);
    if (!used) ++reporter_.refused["ranges_unusable"];
  }

  /// Of whole frames; what vision refuses has counters of its own.
  void count_refused(Reason reason) {
    switch (reason) {
      case Reason::frame_stale: ++reporter_.refused["frames_stale"]; break;
      case Reason::frame_time_not_advancing: ++reporter_.refused["frames_not_advancing"]; break;
      case Reason::frame_time_implausible: ++reporter_.refused["frames_implausible"]; break;
      case Reason::picture_repeated: ++reporter_.refused["frames_repeated"]; break;
      case Reason::ranges_not_fresh: ++reporter_.refused["frames_without_ranges"]; break;
      case Reason::camera_frozen: ++reporter_.refused["frames_frozen"]; break;
      default: break;
    }
  }

  void count_epochs() {
    if (coordinator_.clock_epochs() == epochs_) return;
    epochs_ = coordinator_.clock_epochs();
    spdlog::warn("the clock of the images was set, and they agree on a new time. Starting from rest");
  }

  const LoopConfig& config_;
  const LoopParts& parts_;
  Coordinator& coordinator_;
  Reporter reporter_;
  LatencyWatch latency_;
  SearchBudget search_;
  std::int64_t searches_ = 0;
  SimulatedClock clock_;
  RateMeter rate_;
  StepTiming timing_;
  std::optional<std::int64_t> last_utime_;
  static constexpr double kSetpointLines_s = 0.5;
  std::optional<Setpoint> logged_setpoint_;
  MonotonicTime setpoint_logged_at_;
  std::int64_t setpoints_not_logged_ = 0;
  std::int64_t epochs_ = 0;
};

}  // namespace

void control_loop(const LoopConfig& config, const LoopParts& parts, Coordinator& coordinator) {
  Loop(config, parts, coordinator).run();
}

}  // namespace pilotfish::apps
