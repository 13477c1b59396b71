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

/// When something arrived that the kernel stamped with the wall clock, on the monotonic clock. It may have waited
/// in the kernel for as long as this process was stopped, and it is as old as it is:
///
///   arrival = now - (wall clock now - stamp), between `empty` and now,
///
/// where `empty` is the last instant at which it had not come yet. Both clocks are slewed alike, so their difference
/// changes only when somebody sets the wall clock. Then the stamp means nothing, and the oldest arrival that is
/// possible is taken: `empty`.
MonotonicTime arrival_of(std::int64_t stamp_wall_us, const Clocks& empty, const Clocks& now) noexcept;

}  // namespace pilotfish::bus
