#include "pilotfish/control/heading_controller.hpp"

#include "pilotfish/core/angles.hpp"

namespace pilotfish::control {

const std::vector<Parameter<HeadingControllerConfig>>& HeadingControllerConfig::parameters() {
  static const std::vector<Parameter<HeadingControllerConfig>> table = {
      {"gain_per_s", &HeadingControllerConfig::gain_per_s, 0.0, 20.0, "turn rate per radian of bearing error"},
  };
  return table;
}

double heading_turn_rate(const HeadingControllerConfig& config, double bearing_rad, double bearing_setpoint_rad) {
  return config.gain_per_s * wrap_angle(bearing_rad - bearing_setpoint_rad);
}

}  // namespace pilotfish::control
