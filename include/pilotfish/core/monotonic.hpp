#pragma once

#include <cstdint>

namespace pilotfish {

/// An instant on this host's monotonic clock, which nobody can set: what ages are measured on. A type of its own, so
/// that it cannot be mixed up with an image's stamp (utime), which is whatever its sender says.
struct MonotonicTime {
  std::int64_t us = 0;
};

inline bool operator==(MonotonicTime a, MonotonicTime b) { return a.us == b.us; }
inline bool operator!=(MonotonicTime a, MonotonicTime b) { return a.us != b.us; }
inline bool operator<(MonotonicTime a, MonotonicTime b) { return a.us < b.us; }
inline bool operator<=(MonotonicTime a, MonotonicTime b) { return a.us <= b.us; }

/// CLOCK_BOOTTIME: it also counts the time a suspended computer slept, in which a leader can walk away. For programs
/// and edges (capture, bus) only; what computes is given the time.
MonotonicTime monotonic_now() noexcept;

}  // namespace pilotfish
