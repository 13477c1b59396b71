#pragma once

#include <bot_core/planar_lidar_t.hpp>
#include <cstddef>

#include "checked.hpp"
#include "pilotfish/core/range_scan.hpp"

namespace pilotfish::bus {

/// Of a usable scan.
bot_core::planar_lidar_t encode(const RangeScan& scan);

/// Rejections: ranges_corrupt, ranges_too_many (or none), ranges_time_invalid, ranges_not_finite, ranges_out_of_bounds
/// (a reading beyond kFarthestRange_m, or directions more than once around).
Checked<RangeScan> decode_ranges(const void* data, std::size_t size_bytes);

}  // namespace pilotfish::bus
