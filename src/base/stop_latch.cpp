#include "pilotfish/base/stop_latch.hpp"

namespace pilotfish::base {

std::string_view to_string(SetpointVerdict verdict) noexcept {
  switch (verdict) {
    case SetpointVerdict::stopped: return "stopped";
    case SetpointVerdict::resumed: return "resumed";
    case SetpointVerdict::noted: return "noted";
    case SetpointVerdict::other_session: return "resume_other_session";
    case SetpointVerdict::replayed: return "resume_replayed";
  }
  return "resume_unknown";
}

SetpointVerdict StopLatch::hear(const SetpointHeard& setpoint, std::int64_t obeyed) noexcept {
  const bool ours = obeyed != 0 && setpoint.session == obeyed;
  const bool rises = ours && (setpoint.session != session_ || setpoint.counter > highest_counter_);
  if (rises) {
    session_ = setpoint.session;
    highest_counter_ = setpoint.counter;
  }
  if (!setpoint.run) {
    stopped_ = true;
    return SetpointVerdict::stopped;
  }
  if (!ours) return SetpointVerdict::other_session;
  if (!rises) return SetpointVerdict::replayed;
  if (!stopped_) return SetpointVerdict::noted;
  stopped_ = false;
  return SetpointVerdict::resumed;
}

}  // namespace pilotfish::base
