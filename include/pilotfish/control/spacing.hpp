#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/setpoint.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// Spacing that grows with speed, for chains of robots: see docs/decisions/0050.
struct SpacingConfig {
  PILOTFISH_PARAMETERS(SpacingConfig);
  PILOTFISH_PARAMETER(
      double, headway_s, 0.0, 0.0, 10.0,
      "time headway h: the distance that is kept is d_p + h v with v the robot's own speed ahead; 0: d_p "
      "at every speed. From 2 (latency + lag) on a chain of robots does not amplify");
};

/// The setpoint whose distance is d_p + h v; `own_mps` [m/s] is the robot's speed at the exposure, backwards counts as
/// none. Any law follows it.
Setpoint with_headway(const SpacingConfig& config, const Setpoint& setpoint, double own_mps) noexcept;

}  // namespace pilotfish::control
PILOTFISH_API_END
