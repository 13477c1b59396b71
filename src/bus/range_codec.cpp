#include "range_codec.hpp"

#include <algorithm>
#include <cmath>

#include "wire_reader.hpp"

namespace pilotfish::bus {
namespace {

enum class Counts { right, wrong, too_many };

/// fingerprint, utime, counted readings, counted intensities, two directions: and nothing behind them.
Counts counts_of(const void* data, std::size_t size_bytes) {
  constexpr std::size_t kFloat = 4;
  WireReader reader(data, size_bytes);
  std::int32_t ranges = 0, intensities = 0;
  if (!reader.skip(16) || !reader.read(ranges)) return Counts::wrong;
  if (ranges < 1 || static_cast<std::size_t>(ranges) > kMaxRanges) return Counts::too_many;
  if (!reader.skip(kFloat * static_cast<std::size_t>(ranges)) || !reader.read(intensities)) return Counts::wrong;
  if (intensities < 0 || static_cast<std::size_t>(intensities) > kMaxRanges) return Counts::too_many;
  const bool whole = reader.skip(kFloat * static_cast<std::size_t>(intensities)) && reader.skip(2 * kFloat);
  return whole && reader.at_end() ? Counts::right : Counts::wrong;
}

}  // namespace

bot_core::planar_lidar_t encode(const RangeScan& scan) {
  bot_core::planar_lidar_t message{};
  message.utime = scan.utime;
  message.ranges.assign(scan.ranges_m.begin(), scan.ranges_m.end());
  message.nranges = static_cast<std::int32_t>(message.ranges.size());
  message.nintensities = 0;
  message.rad0 = static_cast<float>(scan.first_rad);
  message.radstep = static_cast<float>(scan.step_rad);
  return message;
}

Checked<RangeScan> decode_ranges(const void* data, std::size_t size_bytes) {
  using Result = Checked<RangeScan>;
  switch (counts_of(data, size_bytes)) {
    case Counts::right: break;
    case Counts::wrong: return Result::reject("ranges_corrupt");
    case Counts::too_many: return Result::reject("ranges_too_many");
  }
  bot_core::planar_lidar_t message;
  if (message.decode(data, 0, static_cast<int>(size_bytes)) < 0) return Result::reject("ranges_corrupt");
  if (!is_usable_time(message.utime)) return Result::reject("ranges_time_invalid");
  const bool finite =
      std::all_of(message.ranges.begin(), message.ranges.end(), [](float r) { return std::isfinite(r); });
  if (!finite || !std::isfinite(message.rad0) || !std::isfinite(message.radstep))
    return Result::reject("ranges_not_finite");
  RangeScan scan;
  scan.utime = message.utime;
  scan.first_rad = static_cast<double>(message.rad0);
  scan.step_rad = static_cast<double>(message.radstep);
  for (float range_m : message.ranges) scan.ranges_m.push_back(range_m);
  if (!is_usable(scan)) return Result::reject("ranges_out_of_bounds");
  return Result::accept(scan);
}

}  // namespace pilotfish::bus
