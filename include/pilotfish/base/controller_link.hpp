#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/monotonic.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::base {

/// Whether the motor controller receives our lines, which is shown only by its echo of a recently sent sequence
/// number: not by lines of a controller that sends but does not receive, of a cable with one broken wire, or out of
/// a full buffer.
class ControllerLink {
 public:
  /// An echo shows for timeout_s that the controller receives.
  explicit ControllerLink(double timeout_s) : timeout_us_(static_cast<std::int64_t>(timeout_s * 1e6)) {}

  /// The number for the line that is sent now.
  std::uint16_t next_sequence(MonotonicTime now) noexcept;
  /// The controller reports this as its last good line.
  void echoed(std::uint16_t sequence) noexcept;
  /// A line sent within timeout_s has been echoed.
  bool alive(MonotonicTime now) const noexcept { return heard_ && now.us - heard_->us <= timeout_us_; }
  /// As if nothing had been echoed; the numbers continue.
  void reset() noexcept { *this = ControllerLink(static_cast<double>(timeout_us_) * 1e-6, sequence_); }

 private:
  struct Sent {
    MonotonicTime at;
    bool valid = false;
  };
  ControllerLink(double timeout_s, std::uint16_t sequence) : ControllerLink(timeout_s) { sequence_ = sequence; }

  static constexpr std::uint16_t kRemembered = 1024;  // a power of two: 5 s at 200 lines a second
  std::int64_t timeout_us_;
  std::uint16_t sequence_ = 0;
  std::array<Sent, kRemembered> sent_{};
  std::optional<MonotonicTime> heard_;  ///< when the newest line that was echoed had been sent
};

}  // namespace pilotfish::base
PILOTFISH_API_END
