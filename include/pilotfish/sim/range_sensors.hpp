#pragma once

#include <cstdint>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/planar_motion.hpp"
#include "pilotfish/core/range_scan.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// A ring of range sensors around a robot's base origin, or a laser. Each sees the nearest surface in its cone.
struct RangeSensors {
  PILOTFISH_PARAMETERS(RangeSensors);
  PILOTFISH_PARAMETER(int, count, 24, 1, 1440, "number of sensors, or of a laser's rays");
  PILOTFISH_PARAMETER(double, first_rad, radians(-172.5), -2 * kPi, 2 * kPi,
                      "direction of the first, in the base frame");
  PILOTFISH_PARAMETER(double, last_rad, radians(172.5), -2 * kPi, 2 * kPi,
                      "and of the last; the others evenly between");
  PILOTFISH_PARAMETER(double, cone_rad, radians(15.0), 0.0, radians(90.0), "full opening of each; 0: a ray");
  PILOTFISH_PARAMETER(double, min_range_m, 0.05, 0.0, 10.0, "what is nearer is measured at this distance");
  PILOTFISH_PARAMETER(double, max_range_m, 3.0, 0.1, 100.0, "reading where nothing is nearer");
  PILOTFISH_PARAMETER(double, noise_sigma_m, 0.01, 0.0, 1.0, "standard deviation of a reading");
  PILOTFISH_PARAMETER(double, dropout, 0.0, 0.0, 1.0, "probability that a sensor gives no reading");
  PILOTFISH_PARAMETER(double, rate_hz, 20.0, 0.1, 1000.0,
                      "of the whole ring; with the nearest exposure of the cameras");
};

/// A vertical cylinder, in plan.
struct Circle2 {
  double x_m = 0.0, y_m = 0.0, radius_m = 0.0;  ///< centre and radius [m]
};

/// Distance from the origin to the nearest point of a circle within the cone around direction_rad; infinite: none is.
double distance_in_cone_m(const Circle2& circle, double direction_rad, double cone_rad) noexcept;

/// What the sensors of a robot read among these circles, in its base frame.
RangeScan scan_of(const RangeSensors& sensors, const std::vector<Circle2>& circles, std::int64_t utime,
                  std::uint64_t seed);

}  // namespace pilotfish::sim
PILOTFISH_API_END
