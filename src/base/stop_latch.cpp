#include "pilotfish/base/stop_latch.hpp"

namespace pilotfish::base {

std::string_view to_string(LatchVerdict verdict) noexcept {
  switch (verdict) {
    case LatchVerdict::stopped: return "stopped";
    case LatchVerdict::resumed: return "resumed";
    case LatchVerdict::already_running: return "already_running";
    case LatchVerdict::other_session: return "resume_other_session";
    case LatchVerdict::replayed: return "resume_replayed";
  }
  return "resume_unknown";
}

LatchVerdict StopLatch::receive(const ReceivedSetpoint& setpoint, std::int64_t accepted_session) noexcept {
  const bool ours = accepted_session != 0 && setpoint.session == accepted_session;
  const bool rises = ours && (setpoint.session != session_ || setpoint.counter > highest_counter_);
  if (rises) {
    session_ = setpoint.session;
    highest_counter_ = setpoint.counter;
  }
  if (!setpoint.run) {
    stopped_ = true;
    return LatchVerdict::stopped;
  }
  if (!ours) return LatchVerdict::other_session;
  if (!rises) return LatchVerdict::replayed;
  if (!stopped_) return LatchVerdict::already_running;
  stopped_ = false;
  return LatchVerdict::resumed;
}

}  // namespace pilotfish::base
