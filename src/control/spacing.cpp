#include "pilotfish/control/spacing.hpp"

#include <algorithm>

namespace pilotfish::control {

/// With k the law's slope and the leader's speed fed forward, a robot on a straight line drives with
///
///   v = v_l + k (d - d_p - h v_l),   d' = v_l - v.
///
/// From the leader's speed to the robot's that is T = ((1 - k h) s + k) / (s + k), so |T| <= 1 at every frequency as
/// long as k h <= 2. A slope of k / (1 + k h) instead of k makes it T = (s + k) / ((1 + k h) s + k), which is so for
/// every h >= 0: what the robot's own speed in place of v_l would give, but without a loop through the delays of camera
/// and wheels. Those are missing here; with them it needs h > 2 (latency + lag).
Setpoint with_headway(const SpacingConfig& config, const Setpoint& setpoint, double leader_mps) noexcept {
  Setpoint wanted = setpoint;
  wanted.distance_m += config.headway_s * std::max(leader_mps, 0.0);
  return wanted;
}

}  // namespace pilotfish::control
