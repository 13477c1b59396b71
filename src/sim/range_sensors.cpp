#include "pilotfish/sim/range_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "random.hpp"

namespace pilotfish::sim {

/// The circle's nearest point lies towards its centre, at rho - R. If that direction is outside the cone by delta, the
/// nearest point within is on the cone's edge, a ray that passes the centre at rho sin(delta): there it enters the
/// circle at rho cos(delta) - sqrt(R^2 - rho^2 sin^2(delta)), if at all.
double distance_in_cone_m(const Circle2& circle, double direction_rad, double cone_rad) noexcept {
  constexpr double kNone_m = std::numeric_limits<double>::infinity();
  const double rho = std::hypot(circle.x_m, circle.y_m), R = circle.radius_m;
  if (rho <= R) return 0.0;
  const double off_rad = std::abs(wrap_angle(std::atan2(circle.y_m, circle.x_m) - direction_rad)) - cone_rad / 2.0;
  if (off_rad <= 0.0) return rho - R;
  const double across_m = rho * std::sin(off_rad);
  if (off_rad >= kPi / 2.0 || across_m > R) return kNone_m;
  return rho * std::cos(off_rad) - std::sqrt(R * R - across_m * across_m);
}

RangeScan scan_of(const RangeSensors& sensors, const std::vector<Circle2>& circles, std::int64_t utime,
                  std::uint64_t seed) {
  RangeScan scan;
  scan.utime = utime;
  scan.first_rad = sensors.first_rad;
  scan.step_rad = sensors.count > 1 ? (sensors.last_rad - sensors.first_rad) / (sensors.count - 1) : 0.0;
  Random random(seed);
  for (int i = 0; i < sensors.count; ++i) {
    const double direction_rad = scan.first_rad + i * scan.step_rad;
    double range_m = sensors.max_range_m;
    for (const Circle2& circle : circles)
      range_m = std::min(range_m, distance_in_cone_m(circle, direction_rad, sensors.cone_rad));
    const double noise_m = sensors.noise_sigma_m * random.normal();  // drawn whether it is used or not
    const bool dropped = random.uniform() < sensors.dropout;
    if (range_m < sensors.max_range_m)
      range_m = std::clamp(range_m + noise_m, sensors.min_range_m, sensors.max_range_m);
    scan.ranges_m.push_back(dropped ? -1.0F : static_cast<float>(range_m));
  }
  return scan;
}

}  // namespace pilotfish::sim
