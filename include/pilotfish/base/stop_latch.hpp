#pragma once

#include <cstdint>
#include <string_view>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::base {

/// A setpoint as it came off the bus; only what is used here.
struct ReceivedSetpoint {
  std::int64_t session = 0;  ///< of the coordinator it is meant for
  std::int64_t counter = 0;  ///< rises within a session
  bool run = false;          ///< false: stop
};

enum class LatchVerdict {
  stopped,          ///< the wheels stand until they are resumed
  resumed,          ///< a stop has ended
  already_running,  ///< running already; its counter is used up
  other_session,    ///< to run, for a session that is not active
  replayed,         ///< to run, with a counter that is not higher than all before
};
/// "resume_other_session", "resume_replayed", ...: at most 24 letters.
std::string_view to_string(LatchVerdict verdict) noexcept;

/// A stop is accepted from anyone and is latched. Only a message to run that gives the active session and a rising
/// counter (and a right mac where a key is configured: the bus checks that) ends it. A stop with such a counter uses it
/// up, so that a message to run that was recorded before a genuine stop, and was lost on its way here, cannot be
/// replayed after it.
class StopLatch {
 public:
  /// `stopped`: the initial state.
  explicit StopLatch(bool stopped = false) : stopped_(stopped) {}

  /// `accepted_session`: the active session; 0: none, and then nothing can resume.
  LatchVerdict receive(const ReceivedSetpoint& setpoint, std::int64_t accepted_session) noexcept;
  bool stopped() const noexcept { return stopped_; }  ///< the wheels stand until they are resumed

 private:
  bool stopped_;
  std::int64_t session_ = 0;  ///< the last session that a message gave; ended ones never become active again
  std::int64_t highest_counter_ = 0;
};

}  // namespace pilotfish::base
PILOTFISH_API_END
