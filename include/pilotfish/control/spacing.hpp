#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/setpoint.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// Spacing that grows with speed, for chains of robots: see docs/decisions/0050.
struct SpacingConfig {
  PILOTFISH_PARAMETERS(SpacingConfig);
  PILOTFISH_PARAMETER(double, headway_s, 0.0, 0.0, 3.0,
                      "time headway h: the distance that is kept is d_p + h v with v the leader's speed away; 0: d_p "
                      "at every speed. From 2 (latency + lag) on a chain of robots does not amplify");
};

/// The setpoint whose distance is d_p + h v; `leader_mps` [m/s]: along the line of sight, towards the robot counts as
/// none. Any law follows it.
Setpoint with_headway(const SpacingConfig& config, const Setpoint& setpoint, double leader_mps) noexcept;

/// The scales of a fuzzy law whose slope, velocity_scale_mps / error_scale_m, is less by 1 + h k: with a headway it
/// must not be steeper than that.
template <class Scales>
Scales with_headway(const SpacingConfig& config, Scales scales) noexcept {
  const double flatter = 1.0 + config.headway_s * scales.velocity_scale_mps / scales.error_scale_m;
  scales.error_scale_m *= flatter;
  scales.error_change_scale_m *= flatter;
  return scales;
}

}  // namespace pilotfish::control
PILOTFISH_API_END
