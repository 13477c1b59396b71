#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/monotonic.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// The monotonic clock of another process, perhaps on another computer, estimated from its messages.
///
/// A message states the time T at which it was sent, on its sender's clock, and has arrived at A on ours: the time at
/// which it is handled, never one from before it was received. It was on its way, or waited, for some time d >= 0, so
/// with the clocks' true difference D
///
///     T - A = D - d <= D :
///
/// each message gives a lower bound of D, and the largest is the nearest. Each is lowered by kDrift of the time since
/// then, more than two clocks drift apart (a quartz by 100 ppm, NTP's adjustment by 500 ppm). A time that is converted
/// with it lies at most at the true one, never after it. Only the last kMessages count: a forged one is soon forgotten.
class RemoteClock {
 public:
  static constexpr double kDrift = 1e-3;        ///< that two clocks drift apart at most, in a second [s]
  static constexpr std::size_t kMessages = 32;  ///< the last ones, which count

  /// remote_us: T, in [0, 2^62]; now: A. Another process, also one that was restarted, needs another RemoteClock.
  void received(std::int64_t remote_us, MonotonicTime now) noexcept;

  /// Our `time` on the other's clock [us], or a little before it; nothing until a message was received.
  std::optional<std::int64_t> convert(MonotonicTime time) const noexcept;

 private:
  struct Bound {
    std::int64_t offset_us = 0;  ///< T - A
    MonotonicTime since;         ///< A
  };

  std::array<Bound, kMessages> bounds_{};  ///< a ring: the n-th message is at n mod kMessages
  std::size_t received_ = 0;
};

}  // namespace pilotfish
PILOTFISH_API_END
