#pragma once

#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// No leader is kept further to the side: there the robot's speed changes the distance by less than cos(70 deg) = 0.34
/// of it, and behind it the wrong way.
inline constexpr double kMaxBearing_rad = radians(70.0);

/// What the coordinator is asked to keep: the paper's d_p and theta_pd, and whether to move at all.
struct Setpoint {
  PILOTFISH_PARAMETERS(Setpoint);
  PILOTFISH_PARAMETER(double, distance_m, 1.0, 0.05, 20.0, "d_p: distance to keep between the two base origins");
  PILOTFISH_PARAMETER(double, bearing_rad, 0.0, -kMaxBearing_rad, kMaxBearing_rad,
                      "theta_pd: observation angle to keep; positive: leader left");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, run, true, "false: stand still, keep looking");
};

}  // namespace pilotfish
PILOTFISH_API_END
