#include "arrival.hpp"

#include <algorithm>
#include <cstdlib>
#include <ctime>

namespace pilotfish::bus {
namespace {

/// A smaller step of the wall clock is no reason for a refusal.
constexpr std::int64_t kNoStepUs = 2000;
/// Three readings in a row normally take less than 1 us; more, and the process was interrupted between them.
constexpr std::int64_t kAtOnceUs = 50;

}  // namespace

Clocks read_clocks() noexcept {
  Clocks clocks;
  for (int attempt = 0; attempt < 4; ++attempt) {
    const MonotonicTime before = monotonic_now();
    timespec wall{};
    clock_gettime(CLOCK_REALTIME, &wall);
    clocks.monotonic = monotonic_now();
    clocks.wall_us = std::int64_t{wall.tv_sec} * 1'000'000 + wall.tv_nsec / 1'000;
    if (clocks.monotonic.us - before.us <= kAtOnceUs) break;
  }
  return clocks;
}

MonotonicTime arrival_of(std::int64_t stamp_wall_us, const Clocks& empty, const Clocks& now) noexcept {
  const std::int64_t step_us = (now.wall_us - empty.wall_us) - (now.monotonic.us - empty.monotonic.us);
  if (std::abs(step_us) > kNoStepUs) return empty.monotonic;
  const std::int64_t longest_us = std::max<std::int64_t>(now.monotonic.us - empty.monotonic.us, 0);
  const std::int64_t waited_us = std::clamp<std::int64_t>(now.wall_us - stamp_wall_us, 0, longest_us);
  return {now.monotonic.us - waited_us};
}

}  // namespace pilotfish::bus
