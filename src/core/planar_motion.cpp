#include "pilotfish/core/planar_motion.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace pilotfish {
namespace {

/// For dr/dt = a constant over a time t,
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

}  // namespace

double sinc(double a) { return std::abs(a) < 1e-4 ? 1.0 - a * a / 6.0 : std::sin(a) / a; }

Pose2 move_along_arc(const Pose2& pose, const Twist& twist, double dt_s) {
  const double half_turn = twist.angular_radps * dt_s / 2.0;
  const double chord = twist.linear_mps * dt_s * sinc(half_turn);
  const double direction = pose.heading_rad + half_turn;
  return {pose.x_m + chord * std::cos(direction), pose.y_m + chord * std::sin(direction),
          wrap_angle(pose.heading_rad + 2.0 * half_turn)};
}

double follow_set_value(double& v, double& r, double target, double max_acceleration, double tau, double t) {
  const double ramp_time = std::min(t, std::abs(target - r) / max_acceleration);
  double distance = 0.0;
  if (ramp_time > 0.0) distance += follow_ramp(v, r, std::copysign(max_acceleration, target - r), tau, ramp_time);
  if (ramp_time < t) {
    r = target;  // without the rounding error of the ramp
    distance += follow_ramp(v, r, 0.0, tau, t - ramp_time);
  }
  return distance;
}

}  // namespace pilotfish
