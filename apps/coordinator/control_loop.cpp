#include "control_loop.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <iostream>

#include "frame_clock.hpp"
#include "latency_watch.hpp"
#include "pilotfish/core/angles.hpp"
#include "stop_signal.hpp"
#include "translate.hpp"

namespace pilotfish::apps {
namespace {

double seconds(MonotonicClock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// Everything that leaves the program, in the order command (the wheels wait), observation, status, log, JSON.
class Reporter {
 public:
  Reporter(const LoopConfig& config, const Coordinator& coordinator, bus::Bus& bus, const Refused& refused,
           const SetpointGate& gate)
      : config_(config), coordinator_(coordinator), bus_(bus), refused_(refused), gate_(gate) {}

  void report(const StepResult& result, std::int64_t image_utime, const StepTiming& timing) {
    bus_.publish(config_.robot, command_report(result, image_utime, gate_.session(), ++counter_));
    bus_.publish(config_.robot, observation_report(result, timing));
    bus::StatusReport status = status_report(result, coordinator_, timing, bus_.rejected());
    status.configured_latency_s = config_.configured_latency_s;
    status.session = gate_.session();
    status.setpoint_counter = gate_.last_counter();
    for (const auto& [name, count] : refused_.setpoints) status.rejected[name] += count;
    status.rejected["frames_stale"] = stale_;
    if (refused_.own_motion > 0) status.rejected["own_motion_unusable"] = refused_.own_motion;
    if (refused_.announcement > 0) status.rejected["announcement_unusable"] = refused_.announcement;
    bus_.publish(config_.robot, status);
    log_change(result);
  }
  void answer_again(const StepResult& result, std::int64_t image_utime) {
    bus_.publish(config_.robot, command_report(result, image_utime, gate_.session(), ++counter_));
  }
  void print(const StepResult& result, const StepTiming& timing) const {
    if (config_.json) std::cout << json_line(result, timing) << std::endl;
  }
  void count_stale() { ++stale_; }

 private:
  /// One line per change of status or reason, however many frames it lasts.
  void log_change(const StepResult& result) {
    if (logged_ && logged_status_ == result.status && logged_reason_ == result.reason) return;
    logged_ = true;
    logged_status_ = result.status;
    logged_reason_ = result.reason;
    const std::string_view reason = to_string(result.reason);
    if (result.observation) {
      spdlog::info("{}{}{}  d = {:.3f} m, bearing = {:.1f} deg", to_string(result.status), reason.empty() ? "" : ": ",
                   reason, result.observation->distance_m, degrees(result.observation->bearing_rad));
    } else {
      spdlog::info("{}{}{}", to_string(result.status), reason.empty() ? "" : ": ", reason);
    }
  }

  const LoopConfig& config_;
  const Coordinator& coordinator_;
  bus::Bus& bus_;
  const Refused& refused_;
  const SetpointGate& gate_;
  std::int64_t counter_ = 0;
  std::int64_t stale_ = 0;
  bool logged_ = false;
  Status logged_status_ = Status::searching;
  Reason logged_reason_ = Reason::none;
};

/// Frames per second over roughly the last ten frames.
class RateMeter {
 public:
  double arrived(MonotonicClock::time_point at) {
    if (last_) {
      const double interval_s = std::max(seconds(at - *last_), 1e-6);
      interval_s_ = interval_s_ > 0.0 ? 0.9 * interval_s_ + 0.1 * interval_s : interval_s;
    }
    last_ = at;
    return interval_s_ > 0.0 ? 1.0 / interval_s_ : 0.0;
  }

 private:
  std::optional<MonotonicClock::time_point> last_;
  double interval_s_ = 0.0;
};

std::int64_t wall_utime() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

}  // namespace

void control_loop(const LoopConfig& config, FrameFeed& feed, Coordinator& coordinator, bus::Bus& bus,
                  const Refused& refused, const SetpointGate& gate) {
  const auto period =
      std::chrono::duration_cast<MonotonicClock::duration>(std::chrono::duration<double>(1.0 / config.frame_rate_hz));
  // A frame that is a little late is no reason for a heartbeat of its own.
  const auto patience = period + period / 2;
  FrameClock clock(wall_utime(), MonotonicClock::now());
  RateMeter rate;
  Reporter reporter(config, coordinator, bus, refused, gate);
  LatencyWatch latency(config);
  StepTiming timing;
  auto next_beat = MonotonicClock::now() + patience;

  while (!stop_requested()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(next_beat - MonotonicClock::now());
    const std::optional<Arrival> arrival = feed.wait(std::max(left, std::chrono::milliseconds(1)));
    if (feed.ended()) break;
    bus.handle(0);  // setpoints, odometry, announcements

    if (!arrival) {
      const auto now = MonotonicClock::now();
      if (now < next_beat) continue;
      reporter.report(coordinator.without_frame(clock.utime_at(now)), clock.last_utime().value_or(0), timing);
      next_beat = now + period;
      continue;
    }
    if (clock.last_utime() == arrival->frame.utime && !config.every_frame) {
      // The same picture again: the simulator asks for an answer that got lost. The old one holds while it is fresh.
      reporter.answer_again(coordinator.without_frame(clock.utime_at(arrival->at)), arrival->frame.utime);
      continue;
    }
    timing.frame_rate_hz = rate.arrived(arrival->at);
    if (!config.every_frame && clock.wall_clock_jumped(wall_utime(), MonotonicClock::now()))
      spdlog::warn("the wall clock has been set; images stamped before that count as too old");
    clock.arrived(*arrival);
    StepResult result;
    if (!config.every_frame && clock.is_stale(*arrival, config.max_age_s)) {
      reporter.count_stale();
      result = coordinator.without_frame(clock.utime_at(arrival->at), Reason::frame_stale);
    } else {
      const auto begin = MonotonicClock::now();
      result = coordinator.step(arrival->frame);
      timing.processing_s = seconds(MonotonicClock::now() - begin);
    }
    latency.answered(*arrival, clock, timing);
    reporter.report(result, arrival->frame.utime, timing);
    reporter.print(result, timing);
    next_beat = MonotonicClock::now() + patience;
  }

  // Zeros are the last thing the wheels hear; three times, because a datagram may be lost.
  Setpoint stop = coordinator.setpoint();
  stop.run = false;
  coordinator.set_setpoint(stop);
  const StepResult zeros = coordinator.without_frame(clock.utime_at(MonotonicClock::now()));
  for (int i = 0; i < 3; ++i) reporter.report(zeros, clock.last_utime().value_or(0), timing);
}

}  // namespace pilotfish::apps
