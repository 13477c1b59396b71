#include "pilotfish/core/monotonic.hpp"

#include <ctime>

namespace pilotfish {
namespace {

std::int64_t read_us(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1'000;
}

}  // namespace

MonotonicTime monotonic_now() noexcept { return {read_us(CLOCK_BOOTTIME)}; }

std::int64_t unsuspended_now_us() noexcept { return read_us(CLOCK_MONOTONIC); }

std::int64_t wall_utime() noexcept { return read_us(CLOCK_REALTIME); }

}  // namespace pilotfish
