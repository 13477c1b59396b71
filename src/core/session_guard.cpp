#include "pilotfish/core/session_guard.hpp"

#include "pilotfish/core/angles.hpp"

namespace pilotfish {
namespace {

/// The bounds of Setpoint::parameters(), without an exception: this runs between two frames. NaN is in no bounds.
bool is_in_bounds(const Setpoint& setpoint) {
  for (const Parameter<Setpoint>& parameter : Setpoint::parameters())
    if (const auto* member = std::get_if<double Setpoint::*>(&parameter.member))
      if (!(setpoint.**member >= parameter.min && setpoint.**member <= parameter.max)) return false;
  return true;
}

}  // namespace

std::string_view to_string(SequenceVerdict verdict) noexcept {
  switch (verdict) {
    case SequenceVerdict::accepted: return "accepted";
    case SequenceVerdict::wrong_session: return "wrong_session";
    case SequenceVerdict::not_rising: return "not_rising";
  }
  return "unknown";
}

SequenceVerdict SequenceGuard::check(std::int64_t session, std::int64_t counter) const noexcept {
  if (session_ == 0 || session != session_) return SequenceVerdict::wrong_session;
  return counter > last_counter_ ? SequenceVerdict::accepted : SequenceVerdict::not_rising;
}

SequenceVerdict SequenceGuard::accept(std::int64_t session, std::int64_t counter) noexcept {
  const SequenceVerdict verdict = check(session, counter);
  if (verdict == SequenceVerdict::accepted) last_counter_ = counter;
  return verdict;
}

std::string_view to_string(SetpointVerdict verdict) noexcept {
  switch (verdict) {
    case SetpointVerdict::accepted: return "setpoint_accepted";
    case SetpointVerdict::stopped: return "setpoint_stopped";
    case SetpointVerdict::wrong_session: return "setpoint_wrong_session";
    case SetpointVerdict::replayed: return "setpoint_replayed";
    case SetpointVerdict::too_near: return "setpoint_too_near";
    case SetpointVerdict::out_of_bounds: return "setpoint_out_of_bounds";
  }
  return "unknown";
}

SetpointVerdict SetpointGate::check(std::int64_t session, std::int64_t counter, const Setpoint& asked) const {
  switch (sequence_.check(session, counter)) {
    case SequenceVerdict::wrong_session: return SetpointVerdict::wrong_session;
    case SequenceVerdict::not_rising: return SetpointVerdict::replayed;
    case SequenceVerdict::accepted: break;
  }
  if (!is_in_bounds(asked)) return SetpointVerdict::out_of_bounds;
  return asked.distance_m < stop_distance_m_ ? SetpointVerdict::too_near : SetpointVerdict::accepted;
}

SetpointDecision SetpointGate::decide(std::int64_t session, std::int64_t counter, const Setpoint& asked,
                                      const Setpoint& kept) {
  const SetpointVerdict verdict = check(session, counter, asked);
  const bool acceptable = verdict == SetpointVerdict::accepted;
  if (acceptable) sequence_.accept(session, counter);
  Setpoint setpoint = acceptable ? asked : kept;
  if (asked.run) return {verdict, setpoint};
  setpoint.run = false;
  return {SetpointVerdict::stopped, setpoint};
}

}  // namespace pilotfish
