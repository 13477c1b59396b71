#pragma once

#include <cstdint>

#include "allocation_counter.hpp"

/// In a test's first line: sanitizers keep the allocator for themselves.
#define PILOTFISH_NEEDS_ALLOCATION_COUNTER() \
  if (!pilotfish::probes::can_count_allocations()) GTEST_SKIP() << "a sanitizer has the allocator"

namespace pilotfish::tests {

/// How often `work` asks for memory.
template <class Work>
std::int64_t memory_asked_for(Work&& work) {
  const std::int64_t before = probes::allocations();
  work();
  return probes::allocations() - before;
}

}  // namespace pilotfish::tests
