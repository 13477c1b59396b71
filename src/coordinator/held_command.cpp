#include "pilotfish/coordinator/held_command.hpp"

namespace pilotfish {
namespace {

/// Whether the picture is at fault rather than the leader absent.
bool is_invalid_input(Reason reason) {
  const auto number = static_cast<std::size_t>(reason);
  return number < kReasons.size() && kReasons[number].kind == ReasonKind::input;
}

}  // namespace

HeldAnswer HeldCommand::at(MonotonicTime now, Reason reason) const noexcept {
  if (!run) return {Status::stopped, Reason::stop_requested, Twist{}};
  const bool fresh = fresh_at(now);
  const Twist twist = fresh ? command : Twist{};
  if (is_invalid_input(reason)) return {Status::invalid_input, reason, twist};
  if (fresh && turning) return {Status::lost, Reason::turning_to_search, twist};
  if (fresh) return {Status::coasting, reason, twist};
  return {ever_measured ? Status::lost : Status::searching, reason, twist};
}

}  // namespace pilotfish
