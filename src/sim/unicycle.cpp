#include "pilotfish/sim/unicycle.hpp"

#include <algorithm>
#include <cmath>

namespace pilotfish::sim {

const std::vector<Parameter<DriveConfig>>& DriveConfig::parameters() {
  static const std::vector<Parameter<DriveConfig>> table = {
      {"max_linear_mps", &DriveConfig::max_linear_mps, 0.0, 20.0, "top speed, forwards and backwards"},
      {"max_linear_acceleration_mps2", &DriveConfig::max_linear_acceleration_mps2, 1e-3, 1e3,
       "greatest change of the set speed"},
      {"max_angular_radps", &DriveConfig::max_angular_radps, 0.0, 50.0, "top turn rate, either way"},
      {"max_angular_acceleration_radps2", &DriveConfig::max_angular_acceleration_radps2, 1e-3, 1e4,
       "greatest change of the set turn rate"},
      {"actuator_lag_s", &DriveConfig::actuator_lag_s, 0.0, 5.0, "time constant of the wheels; 0: none"},
      {"command_timeout_s", &DriveConfig::command_timeout_s, 0.0, 60.0,
       "a command that is not renewed for so long is taken as zero; 0: never"},
  };
  return table;
}

Unicycle::Unicycle(const DriveConfig& drive, const Pose2& start) : drive_(drive) { state_.pose = start; }

void Unicycle::advance(const Twist& command, double duration_s) {
  const double linear = std::clamp(command.linear_mps, -drive_.max_linear_mps, drive_.max_linear_mps);
  const double angular = std::clamp(command.angular_radps, -drive_.max_angular_radps, drive_.max_angular_radps);
  // Equal steps, so that none is a rounding error long.
  const long steps = std::max(1L, std::lround(std::ceil(duration_s / kSubStep_s - 1e-9)));
  const double dt_s = duration_s / static_cast<double>(steps);
  if (!(dt_s > 0.0)) return;
  for (long step = 0; step < steps; ++step) {
    Twist mean;
    mean.linear_mps = follow_set_value(state_.twist.linear_mps, set_value_.linear_mps, linear,
                                       drive_.max_linear_acceleration_mps2, drive_.actuator_lag_s, dt_s) /
                      dt_s;
    mean.angular_radps = follow_set_value(state_.twist.angular_radps, set_value_.angular_radps, angular,
                                          drive_.max_angular_acceleration_radps2, drive_.actuator_lag_s, dt_s) /
                         dt_s;
    state_.pose = move_along_arc(state_.pose, mean, dt_s);
  }
}

}  // namespace pilotfish::sim
