#pragma once

#include <vector>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish {

/// What the coordinator is asked to keep: the paper's d_p and theta_pd, and whether to move at all.
struct Setpoint {
  double distance_m = 1.0;   ///< d_p, between the two robots' base origins
  double bearing_rad = 0.0;  ///< theta_pd, positive: the leader is kept to the left
  bool run = true;           ///< false: stand still, keep looking
  static const std::vector<Parameter<Setpoint>>& parameters();
};

}  // namespace pilotfish
