#include "pilotfish/control/heading_controller.hpp"

#include "pilotfish/core/angles.hpp"

namespace pilotfish::control {

double heading_turn_rate(const HeadingControllerConfig& config, double bearing_rad, double bearing_setpoint_rad) {
  return config.gain_per_s * wrap_angle(bearing_rad - bearing_setpoint_rad);
}

}  // namespace pilotfish::control
