#include "pilotfish/coordinator/held_command.hpp"

namespace pilotfish {
namespace {

/// Reasons that are the picture's fault rather than the leader's absence.
bool is_invalid_input(Reason reason) {
  switch (reason) {
    case Reason::frame_size_not_calibrated:
    case Reason::frame_too_small:
    case Reason::frame_too_large:
    case Reason::frame_truncated:
    case Reason::frame_stride_invalid:
    case Reason::frame_time_not_advancing:
    case Reason::frame_time_implausible:
    case Reason::frame_stale:
    case Reason::camera_frozen:
    case Reason::another_coordinator:
    case Reason::internal_error: return true;
    default: return false;
  }
}

}  // namespace

HeldAnswer HeldCommand::at(MonotonicTime now, Reason reason) const noexcept {
  if (!run) return {Status::stopped, Reason::stop_requested, Twist{}};
  const bool fresh = fresh_at(now);
  const Twist twist = fresh ? command : Twist{};
  if (is_invalid_input(reason)) return {Status::invalid_input, reason, twist};
  if (fresh) return {Status::coasting, reason, twist};
  return {ever_measured ? Status::lost : Status::searching, reason, twist};
}

}  // namespace pilotfish
