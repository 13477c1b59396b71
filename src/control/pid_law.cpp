#include "pilotfish/control/pid_law.hpp"

#include <algorithm>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::control {

Twist PidLaw::follow(const Observation& observation, const Setpoint& setpoint, double dt_s) noexcept {
  const PidConfig& c = config_;
  Twist wanted;
  wanted.linear_mps = control(distance_, observation.distance_m - setpoint.distance_m, c.distance_kp, c.distance_ki,
                              c.distance_kd, -limits_.max_reverse_mps, limits_.max_linear_mps, dt_s);
  wanted.angular_radps =
      control(bearing_, wrap_angle(observation.bearing_rad - setpoint.bearing_rad), c.bearing_kp, c.bearing_ki,
              c.bearing_kd, -limits_.max_angular_radps, limits_.max_angular_radps, dt_s);
  return wanted;
}

/// u = kp e + ki I + kd e', with e' behind a low-pass of time constant tau: e' += dt / (tau + dt) (de/dt - e').
double PidLaw::control(Axis& axis, double error, double kp, double ki, double kd, double least, double most,
                       double dt_s) const noexcept {
  const double dt = std::max(dt_s, 0.0);
  if (axis.last_error && dt > 0.0)
    axis.rate += dt / (config_.derivative_filter_s + dt) * ((error - *axis.last_error) / dt - axis.rate);
  axis.last_error = error;
  const double wanted = kp * error + ki * (axis.integral + error * dt) + kd * axis.rate;
  if (wanted >= least && wanted <= most) axis.integral += error * dt;
  return std::clamp(wanted, least, most);
}

}  // namespace pilotfish::control
