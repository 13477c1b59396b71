#include "pilotfish/control/anticipating_law.hpp"

#include <algorithm>
#include <cmath>

#include "forward_speed.hpp"
#include "pilotfish/core/angles.hpp"

namespace pilotfish::control {
namespace {

constexpr double kMinDistance_m = 0.05;

/// Rate of the bearing if the robot does not turn, from the leader's and from its own speed.
double bearing_rate(const LeaderMotion& leader, double own_linear_mps) {
  return (leader.tangential_mps + own_linear_mps * std::sin(leader.bearing_rad)) /
         std::max(leader.distance_m, kMinDistance_m);
}

}  // namespace

double feed_forward_weight(const AnticipateConfig& config, const LeaderMotion& leader) noexcept {
  const double sigma = std::max(leader.radial_sigma_mps, leader.tangential_sigma_mps) / config.half_weight_sigma_mps;
  return 1.0 / (1.0 + sigma * sigma);
}

/// The leader at distance d and bearing theta drives with the radial speed v_r = v_l cos(psi - theta) and the
/// tangential speed v_t = v_l sin(psi - theta). The robot's own (v, w) has the parts v cos(theta) and -v sin(theta)
/// along and across the line of sight, and turning by w turns the line of sight by -w, hence
///
///   d'     = v_r - v cos(theta)
///   theta' = (v_t + v sin(theta)) / d - w.
///
/// With u the fuzzy law's speed (positive when too far), d' = -u and theta' = -gain (theta - theta_pd) follow from
///
///   v = (v_r + u) / cos(theta)
///   w = gain (theta - theta_pd) + (v_t + v sin(theta)) / d.
///
/// So e -> 0 whatever the leader's speed: u(0, 0) = 0 is the only equilibrium, and theta stays where it is wanted.
Anticipation anticipate(const fuzzy::Controller& controller, const FuzzyVelocityConfig& paper,
                        const AnticipateConfig& config, const LeaderMotion& leader, const Twist& own,
                        const Setpoint& setpoint) {
  FuzzyVelocityConfig scales = paper;
  scales.error_scale_m = config.error_scale_m;
  scales.error_change_scale_m = config.error_change_scale_m;
  scales.velocity_scale_mps = config.velocity_scale_mps;
  // ec is the predicted error's rate times T: e' = -d' = v cos(theta) - v_r.
  const double error_rate_mps = own.linear_mps * std::cos(leader.bearing_rad) - leader.radial_mps;
  const double error_m = setpoint.distance_m - leader.distance_m;
  const double period_s = scales.control_period_s;

  Anticipation result;
  result.velocity = fuzzy_velocity(controller, scales, setpoint.distance_m, leader.distance_m,
                                   error_m - error_rate_mps * period_s, period_s);
  result.wanted.linear_mps = forward_speed(leader.radial_mps + result.velocity.linear_mps, leader.bearing_rad);
  result.wanted.angular_radps = config.heading_gain_per_s * wrap_angle(leader.bearing_rad - setpoint.bearing_rad) +
                                bearing_rate(leader, own.linear_mps);
  return result;
}

/// At full acceleration a up to the top speed V, the acceleration would end within one frame: a jerk of a / dt. With
/// time constant T,
///
///   v' = (V - v) / T
///
/// takes over where that is less than a, the last a T below V, and costs (a T)^2 / 2a of way.
double eased_speed(const AnticipateConfig& config, const LimitsConfig& limits, double previous_mps,
                   double dt_s) noexcept {
  if (!(config.ease_time_s > 0.0)) return limits.max_linear_mps;
  const double share = std::clamp(dt_s / config.ease_time_s, 0.0, 1.0);
  return previous_mps + share * (limits.max_linear_mps - previous_mps);
}

/// At each edge of the view the bearing may change only as fast as (edge - theta) / guard time: so an edge is
/// approached exponentially and never crossed. theta' = b - w with b the rate without turning, so w is bounded on both
/// sides:
///
///   b - (left - theta) / T <= w <= b - (right - theta) / T.
///
/// Where that takes more turn rate than the robot has, its own share v sin(theta) / d of b is bounded instead.
Twist keep_in_view(const AnticipateConfig& config, const FieldOfView& view, const LimitsConfig& limits,
                   const LeaderMotion& leader, const Twist& wanted) noexcept {
  const double most = limits.max_angular_radps, sine = std::sin(leader.bearing_rad);
  const double d = std::max(leader.distance_m, kMinDistance_m);
  const double to_left = (view.left_rad - leader.bearing_rad) / config.guard_time_s;
  const double to_right = (view.right_rad - leader.bearing_rad) / config.guard_time_s;
  Twist kept = wanted;
  // Speeds at which the bound on w is just the greatest turn rate: v sin(theta) / d in [to_right - most, to_left +
  // most] minus the leader's share. Only forward speed is given up, and only down to standing still.
  const double share = leader.tangential_mps / d;
  if (kept.linear_mps > 0.0 && std::abs(sine) > 1e-6) {
    const double edge = sine > 0.0 ? to_left + most : to_right - most;
    kept.linear_mps = std::clamp((edge - share) * d / sine, 0.0, kept.linear_mps);
  }
  const double b = bearing_rate(leader, kept.linear_mps);
  const double least = std::clamp(b - to_left, -most, most), greatest = std::clamp(b - to_right, -most, most);
  if (least <= greatest) kept.angular_radps = std::clamp(kept.angular_radps, least, greatest);
  return kept;
}

}  // namespace pilotfish::control
