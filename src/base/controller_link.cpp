#include "pilotfish/base/controller_link.hpp"

namespace pilotfish::base {

std::uint16_t ControllerLink::next_sequence(MonotonicTime now) noexcept {
  ++sequence_;
  sent_[sequence_ % kRemembered] = {now, true};
  return sequence_;
}

void ControllerLink::echoed(std::uint16_t sequence) noexcept {
  // How many lines ago, modulo 2^16 like the numbers themselves: older lines are not stored.
  const auto behind = static_cast<std::uint16_t>(sequence_ - sequence);
  const Sent& sent = sent_[sequence % kRemembered];
  if (behind >= kRemembered || !sent.valid) return;
  if (!heard_ || *heard_ < sent.at) heard_ = sent.at;
}

}  // namespace pilotfish::base
