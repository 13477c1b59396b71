#pragma once

#include <cstdint>
#include <limits>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// Two times off a wire may be farther apart than an int64 can say, so they are subtracted as doubles: exact to the
/// microsecond up to the year 2255.
inline double seconds_between(std::int64_t from_utime, std::int64_t to_utime) noexcept {
  return (static_cast<double>(to_utime) - static_cast<double>(from_utime)) * 1e-6;
}

/// `utime` a while later; the last time there is, where the clock ends before.
inline std::int64_t later(std::int64_t utime, std::int64_t microseconds) noexcept {
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  return microseconds > 0 && utime > kLast - microseconds ? kLast : utime + microseconds;
}

/// The same in seconds; 0 or more, and no longer than a year.
inline std::int64_t later_s(std::int64_t utime, double seconds) noexcept {
  return later(utime, static_cast<std::int64_t>(seconds * 1e6));
}

}  // namespace pilotfish
PILOTFISH_API_END
