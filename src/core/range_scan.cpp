#include "pilotfish/core/range_scan.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace pilotfish {

bool is_usable(const RangeScan& scan) noexcept {
  constexpr double kOnce_rad = 2.0 * kPi + 1e-6;
  const double between = static_cast<double>(scan.ranges_m.size()) - 1.0;
  return !scan.ranges_m.empty() && std::abs(scan.first_rad) <= kOnce_rad &&
         std::abs(scan.step_rad) * between <= kOnce_rad &&
         std::all_of(scan.ranges_m.begin(), scan.ranges_m.end(),
                     [](float range_m) { return std::isfinite(range_m) && range_m <= kFarthestRange_m; });
}

}  // namespace pilotfish
