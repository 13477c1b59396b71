#pragma once

#include <cstdint>

namespace pilotfish::probes {

/// How often this process has asked for memory: malloc, calloc, realloc, posix_memalign, aligned_alloc and memalign,
/// from whatever library (operator new ends there too).
std::int64_t allocations() noexcept;

/// False under sanitizers, which have these functions for themselves.
bool can_count_allocations() noexcept;

}  // namespace pilotfish::probes
