#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::base {

/// A command as it came off the bus, where its mac has been checked.
struct ReceivedCommand {
  std::int64_t session = 0;       ///< the sender's; 0: none
  std::int64_t counter = 0;       ///< rises within a session
  std::int64_t base_session = 0;  ///< of the wheels' process, as received by the sender
  MonotonicTime valid_until;      ///< on this process's clock: its measurement is too old from then on. Not for zeros
  Twist twist;                    ///< in the robot's base frame
  bool simulated = false;         ///< never for real wheels
};

/// The result of checking a command. Only `accepted` can move the wheels.
enum class CommandVerdict {
  accepted,
  malformed,           ///< no session, a number that is not finite, or a validity longer than any measurement's
  base_session_wrong,  ///< meant for another run of this process: a recording, or a sender that has not received ours
                       ///< yet
  simulated,           ///< of a simulator's or a recording's time, and these are real wheels
  replayed,            ///< a counter of this session that is not higher than all before
  stale,               ///< waited too long between its arrival and now
  expired,             ///< its measurement is too old: the sender, or the way here, held it up after it was checked
  after_gap,           ///< this process was not running just now, so the command's arrival time is unknown
  session_ended,       ///< of a sender that another one has replaced
  foreign,             ///< another sender is active
  sessions_full,       ///< more senders than can be stored: no new one is accepted
};
inline constexpr int kCommandVerdicts = 11;
/// "command_replayed", ...: at most 24 letters; "command_accepted" is never counted.
std::string_view to_string(CommandVerdict verdict) noexcept;

/// How long a command is valid, and a silent sender remains active.
struct CommandGuardConfig {
  PILOTFISH_PARAMETERS(CommandGuardConfig);
  PILOTFISH_PARAMETER(
      double, max_command_age_s, 0.095, 0.02, 0.1,
      "a command is valid for this long after its arrival, then zeros; 5 ms below the limit leave time for the line");
  PILOTFISH_PARAMETER(double, takeover_s, 0.5, 0.2, 60.0,
                      "a sender that is silent for longer has ended, and another one may take over");
};

/// Accepts commands for the wheels: from one sender, recent ones, each once.
///
/// A sender is a session. The first one whose command passes every check is active until it has been silent for
/// takeover_s; then the next may begin, which ends the session for good. Of every session the highest
/// counter is stored, active or not, so that recordings of this run are refused as well; recordings of earlier
/// runs carry another base_session.
class CommandGuard {
 public:
  /// `own_session`: of this process, never 0. `simulated_allowed`: the wheels are not real.
  CommandGuard(const CommandGuardConfig& config, std::int64_t own_session, bool simulated_allowed);

  /// `arrived`: when it reached this host, as far as that is known; not after `now`.
  CommandVerdict receive(const ReceivedCommand& command, MonotonicTime arrived, MonotonicTime now) noexcept;

  /// The command to execute at `now`: the last good one, for max_command_age_s after its arrival and while its
  /// measurement is valid. Nothing afterwards.
  std::optional<Twist> command_at(MonotonicTime now) noexcept;
  /// When command_at() ends, if nothing else arrives; nothing if it has ended.
  std::optional<MonotonicTime> deadline() const noexcept;
  /// The active session at `now`; 0: none.
  std::int64_t accepted_session(MonotonicTime now) noexcept;

  /// The largest safety.max_age_s of a coordinator, and a little for the clocks.
  static constexpr std::int64_t kLongestValidity_us = 300'000;
  static constexpr std::size_t kSessions = 1024;  ///< senders that are stored

 private:
  struct Sender {
    std::int64_t session = 0;
    std::int64_t highest_counter = 0;
    bool ended = false;
  };
  Sender* find(std::int64_t session) noexcept;
  void advance(MonotonicTime now) noexcept;

  CommandGuardConfig config_;
  std::int64_t own_session_;
  bool simulated_allowed_;
  BoundedVector<Sender, kSessions> senders_;
  std::int64_t accepted_session_ = 0;
  std::int64_t silent_ = 0;   ///< session that is silent and not yet replaced
  MonotonicTime until_;       ///< when command_ ends
  MonotonicTime last_heard_;  ///< of any message of the active sender, in time or not
  MonotonicTime last_now_;    ///< of the last call of any function
  MonotonicTime gap_until_;   ///< after a pause of this process
  std::optional<Twist> command_;
};

}  // namespace pilotfish::base
PILOTFISH_API_END
