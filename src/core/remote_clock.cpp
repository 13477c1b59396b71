#include "pilotfish/core/remote_clock.hpp"

#include <algorithm>
#include <limits>

namespace pilotfish {

void RemoteClock::received(std::int64_t remote_us, MonotonicTime now) noexcept {
  bounds_[received_++ % kMessages] = {remote_us - now.us, now};
}

std::optional<std::int64_t> RemoteClock::convert(MonotonicTime time) const noexcept {
  if (received_ == 0) return std::nullopt;
  std::int64_t largest_us = std::numeric_limits<std::int64_t>::min();
  for (std::size_t i = 0; i < std::min(received_, kMessages); ++i) {
    const double since_us = static_cast<double>(std::max<std::int64_t>(time.us - bounds_[i].since.us, 0));
    largest_us = std::max(largest_us, bounds_[i].offset_us - static_cast<std::int64_t>(kDrift * since_us));
  }
  return time.us + largest_us;
}

}  // namespace pilotfish
