#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "pilotfish/bus/reports.hpp"
#include "pilotfish/coordinator/coordinator.hpp"
#include "pilotfish/core/remote_clock.hpp"
#include "stage_times.hpp"

namespace pilotfish::apps {

/// The inputs of a command that was sent, for the black box: what the core held, the instant it was evaluated for, and
/// what was missing.
using SentRecord = std::function<void(const HeldCommand& held, MonotonicTime asked_at, Reason missing,
                                      const HeldAnswer& sent, std::int64_t counter)>;

struct SenderConfig {
  std::int64_t session = 0;
  double frame_rate_hz = 30.0;
  double max_age_s = 0.1;
  bool simulated = false;  ///< frames carry a simulated time
  SentRecord record;       ///< may be empty
};

/// The sender's own counts.
struct SenderCounts {
  std::int64_t missed_deadlines = 0;  ///< a zero that left after its measurement had become too old
  std::int64_t rivals_heard = 0;      ///< commands of another sender under this robot's name
  StageTimes lateness;                ///< of what it sends by itself
};

/// Sends the wheels a command: the answer to a frame at once, otherwise one every period, and one at the very moment
/// the last measurement becomes too old. On a thread of its own, so that nothing which computes, prints or waits can
/// delay it; for every caller the age is checked again when a command is sent.
///
/// What can only stop the robot comes from any thread and acts at once: a stop, a rival, a failure.
class CommandSender {
 public:
  /// Called with the lock held, never by two threads at a time.
  using Publish = std::function<void(const bus::CommandReport&)>;

  CommandSender(const SenderConfig& config, Publish publish);
  ~CommandSender();  ///< sends nothing more; finish() first
  CommandSender(const CommandSender&) = delete;
  CommandSender& operator=(const CommandSender&) = delete;

  /// A frame was answered: the command leaves now. `held` is the coordinator's after that. Returns what was really
  /// sent.
  HeldAnswer answer(const StepResult& result, const HeldCommand& held, std::int64_t image_utime);
  /// The same frame was received again: the same answer, as far as it still holds.
  void answer_again(std::int64_t image_utime);
  /// The coordinator's setpoint was set; `stops` of the stops received are included.
  void setpoint_changed(const HeldCommand& held, std::int64_t stops);

  /// A stop was received: zeros from now on, until the coordinator has handled it and a resume. Returns its
  /// number.
  std::int64_t stop_received();
  std::int64_t stops_received() const;
  /// Another sender commands this robot: zeros from both, until a second after the last of the other's.
  void rival_command_received(MonotonicTime now);
  /// The wheels' process announced itself: its session, and its clock when that left, 0 if it states none. It is
  /// compared with the time of this call: a message's time of arrival may be that of a look at the clock before it
  /// came.
  void base_report_received(std::int64_t base_session, std::int64_t base_us);
  /// Zeros with that reason, three times because a datagram may be lost, and nothing after them.
  void finish(Reason reason);

  SenderCounts counts() const;
  /// Commands so far, without waiting for one that is just leaving.
  std::int64_t sent() const { return sent_; }
  /// Of its own thread: it is alive if this rises. Never blocks, so it can be asked while the thread is stuck.
  std::int64_t beats() const { return beats_; }

 private:
  HeldAnswer holds_at(MonotonicTime now, Reason reason) const;
  /// asked_at, missing: the arguments to held_ that gave `answer`.
  void send(const HeldAnswer& answer, std::int64_t image_utime, MonotonicTime now, MonotonicTime asked_at,
            Reason missing);
  MonotonicTime due() const;
  void run();

  const SenderConfig config_;
  const std::int64_t period_us_, patience_us_;
  const Publish publish_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  HeldCommand held_;       ///< its times are those of the monotonic clock, also where the frames' are simulated
  HeldCommand core_held_;  ///< the coordinator's own, for the record
  HeldAnswer last_answer_;
  std::int64_t image_utime_ = 0, base_session_ = 0;
  std::int64_t stops_received_ = 0, stops_applied_ = 0;
  RemoteClock base_clock_;  ///< of base_session_
  std::optional<MonotonicTime> rival_;
  MonotonicTime next_beat_;
  bool deadline_served_ = true;  ///< the zero at the end of what is held has left
  bool finished_ = false;
  std::atomic<std::int64_t> beats_{0};
  std::atomic<std::int64_t> sent_{0};
  SenderCounts counts_;
  std::thread thread_;  // last: it uses everything above
};

}  // namespace pilotfish::apps
