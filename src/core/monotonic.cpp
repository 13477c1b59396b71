#include "pilotfish/core/monotonic.hpp"

#include <ctime>

namespace pilotfish {

MonotonicTime monotonic_now() noexcept {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return {std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1'000};
}

}  // namespace pilotfish
