#include "pilotfish/control/collision_guard.hpp"

#include <algorithm>
#include <cmath>

#include "forward_speed.hpp"

namespace pilotfish::control {
namespace {

constexpr double kRetreat_s = 0.5;  // time constant with which a distance below d_min is given back

}  // namespace

/// The worst leader stops dead, or keeps coming with the speed c = max(-v_r, 0) with which it comes now. At speed v the
/// robot goes on for the delay T and then slows down with a until it recedes as fast as the leader comes, at -c. Until
/// then the gap shrinks with v + c, so it loses
///
///   (v + c) T + (v + c)^2 / 2a <= room        =>   v = -c - a T + sqrt((a T)^2 + 2 a room).
///
/// Without room it recedes by c and by what is missing over kRetreat_s; both agree where there is just none. It can
/// promise d_min as long as c is less than the speed allowed in reverse.
double guarded_speed(const GuardConfig& config, const Reaction& reaction, const LeaderMotion& leader) noexcept {
  const double a = reaction.limits.max_linear_acceleration_mps2, coasting = a * reaction.delay_s;
  const double room_m = leader.distance_m - config.safety_sigmas * leader.distance_sigma_m - config.minimum_distance_m;
  const double closing_mps = std::max(-leader.radial_mps, 0.0);
  if (room_m <= 0.0) return room_m / kRetreat_s - closing_mps;
  return std::sqrt(coasting * coasting + 2.0 * a * room_m) - coasting - closing_mps;
}

/// A forward speed v has the part v cos(theta) along the line of sight.
double guarded_forward_speed(const GuardConfig& config, const Reaction& reaction, const LeaderMotion& leader) noexcept {
  return forward_speed(guarded_speed(config, reaction, leader), leader.bearing_rad);
}

}  // namespace pilotfish::control
