#include "pilotfish/control/spacing.hpp"

#include <algorithm>

namespace pilotfish::control {

/// Why the own speed, and not the leader's. With k the law's slope and the leader's speed fed forward, a robot on a
/// straight line drives with v = v_l + k (d - d_p - h v_ref), and d' = v_l - v. From the leader's place to the robot's:
///
///   v_ref = v_l:  T = ((1 - k h) s + k) / (s + k)      |T| <= 1 at every frequency only if k h <= 2
///   v_ref = v:    T = (s + k) / ((1 + k h) s + k)      |T| <= 1 for every h >= 0
///
/// The delays of camera and wheels are missing there; with them both need h > 2 (latency + lag).
Setpoint with_headway(const SpacingConfig& config, const Setpoint& setpoint, double own_mps) noexcept {
  Setpoint wanted = setpoint;
  wanted.distance_m += config.headway_s * std::max(own_mps, 0.0);
  return wanted;
}

}  // namespace pilotfish::control
