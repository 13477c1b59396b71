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
  double distance_m = 1.0;   ///< d_p, between the two robots' base origins
  double bearing_rad = 0.0;  ///< theta_pd within +-kMaxBearing_rad; positive: the leader is kept to the left
  bool run = true;           ///< false: stand still, keep looking
  static const std::vector<Parameter<Setpoint>>& parameters();
};

}  // namespace pilotfish
PILOTFISH_API_END
