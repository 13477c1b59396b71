#include "pilotfish/sim/unicycle.hpp"

#include <algorithm>
#include <cmath>

namespace pilotfish::sim {

Unicycle::Unicycle(const DriveConfig& drive, const Pose2& start) : drive_(drive) { state_.pose = start; }

void Unicycle::advance(const Twist& command, double duration_s) {
  if (!is_finite(command) || !(duration_s > 0.0) || !std::isfinite(duration_s)) return;
  const double linear = std::clamp(command.linear_mps, -drive_.max_linear_mps, drive_.max_linear_mps);
  const double angular = std::clamp(command.angular_radps, -drive_.max_angular_radps, drive_.max_angular_radps);
  // Equal steps, so that none is a rounding error long.
  const long steps = std::max(1L, std::lround(std::ceil(duration_s / kSubStep_s - 1e-9)));
  const double dt_s = duration_s / static_cast<double>(steps);
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
