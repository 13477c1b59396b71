#pragma once

#include <cstdint>
#include <string_view>

#include "pilotfish/api.hpp"
#include "pilotfish/core/setpoint.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// The result of a SequenceGuard's check of a message.
enum class SequenceVerdict { accepted, wrong_session, not_rising };

std::string_view to_string(SequenceVerdict verdict) noexcept;

/// Distinguishes the messages of one live sender from those of others and from recordings: a session is a number drawn
/// at random, and within it counters only rise. Session 0 stands for none: nothing is accepted.
///
/// Without a key both numbers can be read from the bus and forged; this protects only against mistakes (a log that is
/// played back, a second sender, a datagram that arrives twice). With a key (bus::Key) it rejects every replay.
class SequenceGuard {
 public:
  /// 0: none, nothing is accepted.
  explicit SequenceGuard(std::int64_t session = 0) : session_(session) {}

  /// A refused message changes nothing: it cannot raise the counter for others.
  SequenceVerdict accept(std::int64_t session, std::int64_t counter) noexcept;
  /// What accept() would return.
  SequenceVerdict check(std::int64_t session, std::int64_t counter) const noexcept;

  std::int64_t session() const { return session_; }            ///< whose messages are accepted
  std::int64_t last_counter() const { return last_counter_; }  ///< of the last one accepted; 0: none yet

 private:
  std::int64_t session_;
  std::int64_t last_counter_ = 0;
};

/// The result of a SetpointGate's check of a message.
enum class SetpointVerdict { accepted, stopped, wrong_session, replayed, too_near, out_of_bounds };

/// As the refusals are counted: "setpoint_wrong_session", "setpoint_replayed", ...
std::string_view to_string(SetpointVerdict verdict) noexcept;

/// The check's result and the setpoint that follows from it.
struct SetpointDecision {
  SetpointVerdict verdict = SetpointVerdict::out_of_bounds;  ///< the result of the check
  Setpoint setpoint;                                         ///< to be kept from now on
};

/// Decides which messages may change what a coordinator keeps.
///
///   - A stop (run = false) is accepted from anyone, always, and it is latched: only an accepted message with
///     run = true ends it.
///   - Everything else must name the session, rise above every counter accepted before, and keep a distance of at
///     least stop_distance_m, within the bounds of a Setpoint.
///   - A stop changes the setpoint and the counter only if it would have been accepted with run = true: a forged
///     stop stops the robot and does nothing else. So a recording made before a genuine stop cannot be replayed after
///     it.
///
/// A message's MAC, where a key is configured, has been checked before (bus::Bus); a stop with a wrong one arrives here
/// with session 0.
class SetpointGate {
 public:
  /// `session`: the coordinator's own.
  SetpointGate(std::int64_t session, double stop_distance_m) : sequence_(session), stop_distance_m_(stop_distance_m) {}

  /// `kept` is what has been kept until now.
  SetpointDecision decide(std::int64_t session, std::int64_t counter, const Setpoint& asked, const Setpoint& kept);

  std::int64_t session() const { return sequence_.session(); }            ///< the coordinator's
  std::int64_t last_counter() const { return sequence_.last_counter(); }  ///< goes into StatusReport::setpoint_counter

 private:
  SetpointVerdict check(std::int64_t session, std::int64_t counter, const Setpoint& asked) const;

  SequenceGuard sequence_;
  double stop_distance_m_;
};

}  // namespace pilotfish
PILOTFISH_API_END
