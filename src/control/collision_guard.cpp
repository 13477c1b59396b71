#include "pilotfish/control/collision_guard.hpp"

#include <algorithm>
#include <cmath>

#include "forward_speed.hpp"

namespace pilotfish::control {
namespace {

constexpr double kRetreat_s = 0.5;  // time constant with which a distance below d_min is given back

}  // namespace

/// The worst case. From the exposure on the leader brakes with b until it stands (b = 0 in the configuration: at once),
/// or keeps coming with the speed c = max(-v_r, 0) with which it comes now. The robot's command v acts one latency
/// later, for the hold H: no picture may come any more. Then its set value falls with a. What it covers until the
/// command acts is known from the commands before, so is its real speed v_0 then, and `distance_m` is less by it.
///
/// The wheels follow the set value with a lag tau. Over the whole way to standstill a first-order lag covers tau v_0
/// more than the set value does, whatever the set value does in between. So in the frame that comes with c the gap
/// shrinks by
///
///   (v + c) H + (v + c)^2 / 2a + tau (v_0 + c) - v_l^2 / 2b,
///
/// with v_l >= 0 the leader's speed away. That must fit into room = d - safety_sigmas sigma - d_min, so
///
///   v = -c - a H + sqrt((a H)^2 + 2 a (room - tau (v_0 + c) + v_l^2 / 2b)).
///
/// The gap is smallest at the end, when both stand, because b >= a: whoever brakes harder and earlier is not slower to
/// shrink it. And the next picture can always allow to brake: one period P <= H later the robot has covered v P less,
/// and needs v (H - P) less; the command v' = v - a P fits again. So once it fits it fits for ever: by induction
/// d >= d_min, while the error of a measurement is within safety_sigmas sigma, the drive's latency, lag and
/// deceleration are as assumed, c is not above the speed allowed in reverse and does not grow.
///
/// Without room it recedes by c and by what is missing over kRetreat_s; both agree where there is just none.
double guarded_speed(const GuardConfig& config, const Reaction& reaction, const Gap& gap) noexcept {
  const double a = reaction.limits.max_linear_acceleration_mps2, held = a * reaction.hold_s;
  const double closing_mps = std::max(-gap.leaving_mps, 0.0), leaving_mps = std::max(gap.leaving_mps, 0.0);
  const double braking_m =
      config.leader_deceleration_mps2 > 0.0 ? 0.5 * leaving_mps * leaving_mps / config.leader_deceleration_mps2 : 0.0;
  const double room_m = gap.distance_m - config.safety_sigmas * gap.distance_sigma_m - config.minimum_distance_m +
                        braking_m - reaction.actuator_lag_s * std::max(gap.own_mps + closing_mps, 0.0);
  if (room_m <= 0.0) return room_m / kRetreat_s - closing_mps;
  return std::sqrt(held * held + 2.0 * a * room_m) - held - closing_mps;
}

/// A forward speed v has the part v cos(theta) along the line of sight.
double guarded_forward_speed(const GuardConfig& config, const Reaction& reaction, const Gap& gap) noexcept {
  return forward_speed(guarded_speed(config, reaction, gap), gap.bearing_rad);
}

}  // namespace pilotfish::control
