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
/// more than the set value does, whatever the set value does in between. The set value itself is s when the command
/// acts; if it is above v, it comes down with a. So in the frame that comes with c the gap shrinks by
///
///   need(v) = (v + c) H + (v + c)^2 / 2a + max(s - v, 0)^2 / 2a + tau (v_0 + c) - v_l^2 / 2b,
///
/// with v_l >= 0 the leader's speed away. That must fit into room = d - safety_sigmas sigma - d_min. With x = v + c,
/// y = s + c and r = room - tau (v_0 + c) + v_l^2 / 2b the largest x is
///
///   -a H + sqrt((a H)^2 + 2 a r)                          where that is at least y, else
///   ((y - a H) + sqrt((y - a H)^2 - 2 (y^2 - 2 a r))) / 2   where that is at least y - a H, else 0:
///
/// the set value cannot fall by more than a H during the hold; then nothing fits, and it brakes as hard as it can.
///
/// The gap is smallest at the end, when both stand, because b >= a: whoever brakes harder and earlier is not slower to
/// shrink it. And once need(v) <= room, the next picture, one period P <= H later, finds a command that fits, too: the
/// set value is v then and the room less by v P + (s - v)^2 / 2a, at least v H + v^2 / 2a - v P. The command v - a P
/// needs (v - a P) H + (v - a P)^2 / 2a + a P^2 / 2 = v H + v^2 / 2a - v P + a P (P - H), which is not more; below
/// v = a P the command 0 needs v^2 / 2a. By induction d >= d_min, while the error of a measurement is within
/// safety_sigmas sigma, the drive's latency, lag and deceleration are as assumed, c is not above the speed allowed in
/// reverse and does not grow.
///
/// Without room (r <= 0) it recedes by c and by what is missing over kRetreat_s; both agree where there is just none.
double guarded_speed(const GuardConfig& config, const Reaction& reaction, const Gap& gap) noexcept {
  const double a = reaction.limits.max_linear_acceleration_mps2, held = a * reaction.hold_s;
  const double closing_mps = std::max(-gap.leaving_mps, 0.0), leaving_mps = std::max(gap.leaving_mps, 0.0);
  const double braking_m =
      config.leader_deceleration_mps2 > 0.0 ? 0.5 * leaving_mps * leaving_mps / config.leader_deceleration_mps2 : 0.0;
  const double room_m = gap.distance_m - config.safety_sigmas * gap.distance_sigma_m - config.minimum_distance_m +
                        braking_m - reaction.actuator_lag_s * std::max(gap.own_mps + closing_mps, 0.0);
  if (room_m <= 0.0) return room_m / kRetreat_s - closing_mps;
  const double at_rest = std::sqrt(held * held + 2.0 * a * room_m) - held, set = gap.set_mps + closing_mps;
  if (at_rest >= set) return at_rest - closing_mps;
  const double slowed = set - held, square = slowed * slowed - 2.0 * (set * set - 2.0 * a * room_m);
  const double falling = square >= 0.0 ? 0.5 * (slowed + std::sqrt(square)) : 0.0;
  return (falling >= slowed ? falling : 0.0) - closing_mps;
}

/// A forward speed v has the part v cos(theta) along the line of sight. Forward it counts as if all of it led to the
/// leader: the robot may turn to it while it brakes, and cos(theta) grow to 1. To recede it takes 1 / cos(theta) of it.
double guarded_forward_speed(const GuardConfig& config, const Reaction& reaction, const Gap& gap) noexcept {
  const double speed_mps = guarded_speed(config, reaction, gap);
  return speed_mps > 0.0 ? speed_mps : forward_speed(speed_mps, gap.bearing_rad);
}

}  // namespace pilotfish::control
