#include "command_sender.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "real_time.hpp"

namespace pilotfish::apps {
namespace {

/// Commands are evaluated for an instant this much later: waking up and the way over the bus take time, and the rule
/// applies at the wheels. So the zero at the deadline is sent this much before it, and so is every answer in that
/// time: after a zero, a frame without a measurement must not move the wheels again.
constexpr std::int64_t kSendAhead_us = 6'000;
/// Wheels stop by themselves 100 ms after the last command: so commands are sent more often than that, even with a slow
/// camera.
constexpr std::int64_t kLongestSilence_us = 50'000;
constexpr std::int64_t kRivalFor_us = 1'000'000;
constexpr int kLastZeros = 3;  // a datagram may be lost

MonotonicTime later(MonotonicTime time, std::int64_t by_us) { return {time.us + by_us}; }

}  // namespace

CommandSender::CommandSender(const SenderConfig& config, Publish publish)
    : config_(config),
      period_us_(std::min(static_cast<std::int64_t>(1e6 / config.frame_rate_hz), kLongestSilence_us)),
      // A frame that is a little late is no reason for an extra command.
      patience_us_(std::min(period_us_ + period_us_ / 2, kLongestSilence_us)),
      publish_(std::move(publish)),
      next_beat_(monotonic_now()),
      thread_([this] { run(); }) {}

CommandSender::~CommandSender() {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

HeldAnswer CommandSender::holds_at(MonotonicTime now, Reason reason) const {
  if (rival_ && now.us - rival_->us < kRivalFor_us)
    return {Status::invalid_input, Reason::another_coordinator, Twist{}};
  if (stops_applied_ < stops_received_) return {Status::stopped, Reason::stop_requested, Twist{}};
  return held_.at(now, reason);
}

void CommandSender::send(const HeldAnswer& answer, std::int64_t image_utime, MonotonicTime now, MonotonicTime asked_at,
                         Reason missing) {
  bus::CommandReport report;
  report.utime = image_utime;
  report.session = config_.session;
  report.counter = ++sent_;
  report.base_session = base_session_;
  // Between this and its leaving, the process may be stopped: the wheels must be able to detect that.
  if (!(answer.command == Twist{})) report.valid_until_us = base_clock_.convert(held_.until).value_or(held_.until.us);
  report.simulated = config_.simulated;
  report.command = answer.command;
  report.status = answer.status;
  report.reason = answer.reason;
  publish_(report);
  if (!held_.fresh_at(later(now, kSendAhead_us))) {
    // The wheels rest from here on; the next zero is one of many.
    if (!deadline_served_ && held_.holding && held_.until < now) ++counts_.missed_deadlines;
    deadline_served_ = true;
  }
  if (config_.record && !config_.simulated) config_.record(core_held_, asked_at, missing, answer, report.counter);
}

HeldAnswer CommandSender::answer(const StepResult& result, const HeldCommand& held, std::int64_t image_utime) {
  const std::lock_guard lock(mutex_);
  if (finished_) return {result.status, result.reason, Twist{}};
  const MonotonicTime now = monotonic_now();
  held_ = core_held_ = held;
  image_utime_ = image_utime;
  HeldAnswer answer{result.status, result.reason, result.command};
  if (config_.simulated) {
    // The simulated clock stood still while the frame was processed. From now on real time counts here.
    const bool moves = held.holding && !(result.command == Twist{});
    held_.from = now;
    held_.until = later(now, moves ? static_cast<std::int64_t>(config_.max_age_s * 1e6) : -1);
  }
  const MonotonicTime effective = later(now, kSendAhead_us);
  deadline_served_ = !held_.fresh_at(effective);
  const HeldAnswer holds = holds_at(effective, result.reason);
  const bool overruled = holds.reason == Reason::another_coordinator || holds.status == Status::stopped;
  if (overruled) {
    answer = holds;
  } else if (!(answer.command == Twist{}) && !held_.fresh_at(effective)) {
    // Vision took too long, or a frame without a measurement came in the last moment of the one before.
    answer = held_.at(effective, result.status == Status::tracking ? Reason::frame_stale : result.reason);
  }
  last_answer_ = answer;
  send(answer, image_utime, now, effective, answer.reason);
  next_beat_ = later(now, patience_us_);
  changed_.notify_one();  // what is due next may be due earlier than what the thread waits for
  return answer;
}

void CommandSender::answer_again(std::int64_t image_utime) {
  const std::lock_guard lock(mutex_);
  if (finished_) return;
  const MonotonicTime now = monotonic_now();
  const MonotonicTime effective = later(now, kSendAhead_us);
  HeldAnswer holds = holds_at(effective, last_answer_.reason);
  if (holds.command == last_answer_.command && holds.status != Status::stopped) holds = last_answer_;
  send(holds, image_utime, now, effective, holds.reason);
}

void CommandSender::setpoint_changed(const HeldCommand& held, std::int64_t stops) {
  const std::lock_guard lock(mutex_);
  core_held_ = held;
  held_.run = held.run;
  if (!held.run || !held.holding) held_.holding = false;
  stops_applied_ = std::max(stops_applied_, stops);
}

std::int64_t CommandSender::stop_received() {
  const std::lock_guard lock(mutex_);
  ++stops_received_;
  held_.holding = false;
  const MonotonicTime now = monotonic_now();
  if (!finished_) send(holds_at(now, Reason::stop_requested), image_utime_, now, now, Reason::stop_requested);
  return stops_received_;
}

std::int64_t CommandSender::stops_received() const {
  const std::lock_guard lock(mutex_);
  return stops_received_;
}

void CommandSender::rival_command_received(MonotonicTime now) {
  const std::lock_guard lock(mutex_);
  ++counts_.rivals_heard;
  const bool moving = held_.fresh_at(now) && !(held_.command == Twist{});
  rival_ = now;
  held_.holding = false;
  if (moving && !finished_)
    send(holds_at(now, Reason::another_coordinator), image_utime_, now, now, Reason::another_coordinator);
}

void CommandSender::base_report_received(std::int64_t base_session, std::int64_t base_us) {
  const std::lock_guard lock(mutex_);
  if (base_session != base_session_) base_clock_ = {};
  base_session_ = base_session;
  if (base_us > 0) base_clock_.received(base_us, monotonic_now());
}

void CommandSender::finish(Reason reason) {
  const std::lock_guard lock(mutex_);
  if (finished_) return;
  held_.holding = false;
  const HeldAnswer zeros{reason == Reason::stop_requested ? Status::stopped : Status::invalid_input, reason, Twist{}};
  for (int i = 0; i < kLastZeros; ++i) {
    const MonotonicTime now = monotonic_now();
    send(zeros, image_utime_, now, now, reason);
  }
  finished_ = true;
  changed_.notify_all();
}

SenderCounts CommandSender::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

MonotonicTime CommandSender::due() const {
  if (deadline_served_ || !held_.holding) return next_beat_;
  return std::min(next_beat_, later(held_.until, 1 - kSendAhead_us));  // `until` itself is still fresh
}

void CommandSender::run() {
  become_real_time("commands", kCommandsPriority);
  std::unique_lock lock(mutex_);
  while (!finished_) {
    ++beats_;
    const MonotonicTime now = monotonic_now();
    const MonotonicTime due_at = due();
    if (now < due_at) {
      changed_.wait_for(lock, std::chrono::microseconds(due_at.us - now.us));
      continue;
    }
    counts_.lateness.add(static_cast<double>(now.us - due_at.us) * 1e-6);
    const MonotonicTime effective = later(now, kSendAhead_us);
    send(holds_at(effective, Reason::no_frame), image_utime_, now, effective, Reason::no_frame);
    next_beat_ = later(now, period_us_);
  }
}

}  // namespace pilotfish::apps
