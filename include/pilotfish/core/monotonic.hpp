#pragma once

#include <cstdint>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// An instant on this host's monotonic clock, which cannot be set: ages are measured on it. A type of its own, so
/// that it cannot be confused with an image's stamp (utime), which is the sender's unverified claim.
struct MonotonicTime {
  std::int64_t us = 0;  ///< [us]
};

inline bool operator==(MonotonicTime a, MonotonicTime b) { return a.us == b.us; }
inline bool operator!=(MonotonicTime a, MonotonicTime b) { return a.us != b.us; }
inline bool operator<(MonotonicTime a, MonotonicTime b) { return a.us < b.us; }
inline bool operator<=(MonotonicTime a, MonotonicTime b) { return a.us <= b.us; }

/// CLOCK_BOOTTIME: it also counts the time for which the computer was suspended, in which a leader can drive away. For
/// programs and edges (capture, bus) only; computations are given the time.
MonotonicTime monotonic_now() noexcept;

/// The two other clocks of this host, for stamps made by other programs, in microseconds: the one that stops in
/// suspension (CLOCK_MONOTONIC: V4L2's buffers, most programs' stamps), and the one that can be set (CLOCK_REALTIME:
/// utime). Ages are measured on neither.
std::int64_t unsuspended_now_us() noexcept;
std::int64_t wall_utime() noexcept;

}  // namespace pilotfish
PILOTFISH_API_END
