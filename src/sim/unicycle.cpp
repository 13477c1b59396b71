#include "pilotfish/sim/unicycle.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::sim {
namespace {

double sinc(double a) { return std::abs(a) < 1e-4 ? 1.0 - a * a / 6.0 : std::sin(a) / a; }

/// One axis of the drive: measured speed v behind the set value r. For dr/dt = a constant over a time t,
///
///   v(t) = r + a (t - tau) + (v - r + a tau) exp(-t / tau),
///
/// as one checks by putting it into dv/dt = (r(t) - v) / tau. Returns the integral of v over t:
///
///   (r - a tau) t + a t^2 / 2 + (v - r + a tau) tau (1 - exp(-t / tau)).
double follow_ramp(double& v, double& r, double a, double tau, double t) {
  const double r_start = r;
  r += a * t;
  if (tau <= 0.0) {
    v = r;
    return r_start * t + a * t * t / 2.0;
  }
  const double gap = v - r_start + a * tau;
  const double decay = -std::expm1(-t / tau);  // 1 - exp(-t / tau)
  v = r - a * tau + gap * (1.0 - decay);
  return (r_start - a * tau) * t + a * t * t / 2.0 + gap * tau * decay;
}

/// Ramps r to the target with at most max_acceleration, then holds it; returns the integral of v over t.
double follow(double& v, double& r, double target, double max_acceleration, double tau, double t) {
  const double ramp_time = std::min(t, std::abs(target - r) / max_acceleration);
  double distance = 0.0;
  if (ramp_time > 0.0) distance += follow_ramp(v, r, std::copysign(max_acceleration, target - r), tau, ramp_time);
  if (ramp_time < t) {
    r = target;  // without the rounding error of the ramp
    distance += follow_ramp(v, r, 0.0, tau, t - ramp_time);
  }
  return distance;
}

}  // namespace

const std::vector<Parameter<Pose2>>& Pose2::parameters() {
  static const std::vector<Parameter<Pose2>> table = {
      {"x_m", &Pose2::x_m, -1e4, 1e4, "in the world frame"},
      {"y_m", &Pose2::y_m, -1e4, 1e4, "in the world frame"},
      {"heading_rad", &Pose2::heading_rad, -2 * kPi, 2 * kPi, "0 along the world's x axis, positive to the left"},
  };
  return table;
}

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

Pose2 move_along_arc(const Pose2& pose, const Twist& twist, double dt_s) {
  const double half_turn = twist.angular_radps * dt_s / 2.0;
  const double chord = twist.linear_mps * dt_s * sinc(half_turn);
  const double direction = pose.heading_rad + half_turn;
  return {pose.x_m + chord * std::cos(direction), pose.y_m + chord * std::sin(direction),
          wrap_angle(pose.heading_rad + 2.0 * half_turn)};
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
    mean.linear_mps = follow(state_.twist.linear_mps, set_value_.linear_mps, linear,
                             drive_.max_linear_acceleration_mps2, drive_.actuator_lag_s, dt_s) /
                      dt_s;
    mean.angular_radps = follow(state_.twist.angular_radps, set_value_.angular_radps, angular,
                                drive_.max_angular_acceleration_radps2, drive_.actuator_lag_s, dt_s) /
                         dt_s;
    state_.pose = move_along_arc(state_.pose, mean, dt_s);
  }
}

}  // namespace pilotfish::sim
