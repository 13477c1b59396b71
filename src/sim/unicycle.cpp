#include "pilotfish/sim/unicycle.hpp"

#include <algorithm>
#include <cmath>

#include "random.hpp"

namespace pilotfish::sim {

Unicycle::Unicycle(const DriveConfig& drive, const Pose2& start, std::uint64_t seed) : drive_(drive), seed_(seed) {
  state_.pose = start;
}

/// The wheels turn with v -+ w b / 2.
Twist Unicycle::to_wheel_steps(Twist twist) const {
  const double step_mps = drive_.wheel_step_mps, half_track_m = drive_.track_width_m / 2.0;
  if (!(step_mps > 0.0)) return twist;
  const auto nearest = [step_mps](double speed_mps) { return step_mps * std::round(speed_mps / step_mps); };
  const double left = nearest(twist.linear_mps - twist.angular_radps * half_track_m);
  const double right = nearest(twist.linear_mps + twist.angular_radps * half_track_m);
  return {(left + right) / 2.0, (right - left) / (2.0 * half_track_m)};
}

double Unicycle::slip() {
  if (drive_.slip_sigma == 0.0) return drive_.slip;
  const auto interval = static_cast<std::uint64_t>(elapsed_s_ / kSlipTime_s + 1e-9);
  if (interval != slip_interval_) {
    slip_interval_ = interval;
    slip_ = drive_.slip + drive_.slip_sigma * Random(seed_for(seed_, interval)).normal();
  }
  return slip_;
}

void Unicycle::advance(const Twist& command, double duration_s) {
  if (!is_finite(command) || !(duration_s > 0.0) || !std::isfinite(duration_s)) return;
  const Twist target =
      to_wheel_steps({std::clamp(command.linear_mps, -drive_.max_linear_mps, drive_.max_linear_mps),
                      std::clamp(command.angular_radps, -drive_.max_angular_radps, drive_.max_angular_radps)});
  // Equal steps, so that none is a rounding error long.
  const long steps = std::max(1L, std::lround(std::ceil(duration_s / kSubStep_s - 1e-9)));
  const double dt_s = duration_s / static_cast<double>(steps);
  for (long step = 0; step < steps; ++step) {
    Twist mean;
    mean.linear_mps = follow_set_value(wheels_.linear_mps, set_value_.linear_mps, target.linear_mps,
                                       drive_.max_linear_acceleration_mps2, drive_.actuator_lag_s, dt_s) /
                      dt_s;
    mean.angular_radps = follow_set_value(wheels_.angular_radps, set_value_.angular_radps, target.angular_radps,
                                          drive_.max_angular_acceleration_radps2, drive_.actuator_lag_s, dt_s) /
                         dt_s;
    const double linear_share = drive_.linear_gain * (1.0 - slip());
    mean.linear_mps *= linear_share;
    mean.angular_radps *= drive_.angular_gain;
    state_.pose = move_along_arc(state_.pose, mean, dt_s);
    state_.twist = {wheels_.linear_mps * linear_share, wheels_.angular_radps * drive_.angular_gain};
    elapsed_s_ += dt_s;
  }
}

}  // namespace pilotfish::sim
