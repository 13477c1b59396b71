#pragma once

#include <cstdint>

#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::bus {

/// The monotonic and the wall clock, read at one instant.
struct Clocks {
  MonotonicTime monotonic;
  std::int64_t wall_us = 0;
};

Clocks read_clocks() noexcept;

/// When something arrived that the kernel stamped with the wall clock, on the monotonic clock. The time for
/// which it waited in the kernel, while this process was stopped, is included:
///
///   arrival = now - (wall clock now - stamp), between `empty` and now,
///
/// where `empty` is the last instant at which it had not come yet. Both clocks are slewed alike, so their difference
/// changes only when the wall clock is set. Then the stamp is useless, and the oldest arrival that is
/// possible is taken: `empty`.
MonotonicTime arrival_of(std::int64_t stamp_wall_us, const Clocks& empty, const Clocks& now) noexcept;

}  // namespace pilotfish::bus
