#pragma once

#include <cstdint>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// An instant on this host's monotonic clock, which nobody can set: what ages are measured on. A type of its own, so
/// that it cannot be mixed up with an image's stamp (utime), which is whatever its sender says.
struct MonotonicTime {
  std::int64_t us = 0;  ///< [us]
};

inline bool operator==(MonotonicTime a, MonotonicTime b) { return a.us == b.us; }
inline bool operator!=(MonotonicTime a, MonotonicTime b) { return a.us != b.us; }
inline bool operator<(MonotonicTime a, MonotonicTime b) { return a.us < b.us; }
inline bool operator<=(MonotonicTime a, MonotonicTime b) { return a.us <= b.us; }

/// CLOCK_BOOTTIME: it also counts the time a suspended computer slept, in which a leader can walk away. For programs
/// and edges (capture, bus) only; what computes is given the time.
MonotonicTime monotonic_now() noexcept;

/// The two other clocks of this host, for stamps that somebody else made, in microseconds: the one that a suspension
/// stops (CLOCK_MONOTONIC: V4L2's buffers, most programs' stamps), and the one that people set (CLOCK_REALTIME: utime).
/// Ages are measured on neither.
std::int64_t unsuspended_now_us() noexcept;
std::int64_t wall_utime() noexcept;

}  // namespace pilotfish
PILOTFISH_API_END
