#include "pilotfish/core/setpoint.hpp"

namespace pilotfish {

const std::vector<Parameter<Setpoint>>& Setpoint::parameters() {
  static const std::vector<Parameter<Setpoint>> table = {
      {"distance_m", &Setpoint::distance_m, 0.05, 20.0, "d_p: distance to keep between the two base origins"},
      {"bearing_rad", &Setpoint::bearing_rad, -kMaxBearing_rad, kMaxBearing_rad,
       "theta_pd: observation angle to keep; positive: leader left"},
      {"run", &Setpoint::run, 0, 1, "false: stand still, keep looking"},
  };
  return table;
}

}  // namespace pilotfish
