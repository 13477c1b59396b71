#pragma once

#include <cstddef>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/bounded_vector.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// The most readings of one scan: a laser's at every quarter of a degree.
inline constexpr std::size_t kMaxRanges = 1440;
/// No sensor of such a robot measures farther.
inline constexpr float kFarthestRange_m = 100.0F;

/// One scan of a laser, or one round of a ring of sonars: the distance to the nearest surface in each of several
/// directions, from the robot's base origin (whoever drives a ring adds the ring's radius).
struct RangeScan {
  std::int64_t utime = 0;  ///< of the scan [us]
  double first_rad = 0.0;  ///< direction of the first reading in the base frame, positive: to the left
  double step_rad = 0.0;   ///< from one reading to the next
  BoundedVector<float, kMaxRanges> ranges_m;  ///< [m]; below 0: no reading in that direction
};

/// Whether a scan can be used: readings that are finite and at most kFarthestRange_m, at least one of them; directions
/// that are finite, and once around at most.
bool is_usable(const RangeScan& scan) noexcept;

}  // namespace pilotfish
PILOTFISH_API_END
