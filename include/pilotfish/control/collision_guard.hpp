#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/control/leader_motion_estimator.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// The distance to the leader that no law may go below.
struct GuardConfig {
  PILOTFISH_PARAMETERS(GuardConfig);
  PILOTFISH_PARAMETER(
      double, minimum_distance_m, 0.45, 0.0, 20.0,
      "d_min: whichever law drives, the speed is limited so that the robot can stop at it if the "
      "leader stops dead, and reverses from a leader that comes nearer; not nearer than the camera sees the "
      "leader, which is computed at load");
  PILOTFISH_PARAMETER(double, safety_sigmas, 3.0, 0.0, 10.0,
                      "for d_min the distance is reduced by this many standard deviations");
};

/// The drive: its limits, and the delay until a command takes effect.
struct Reaction {
  LimitsConfig limits;   ///< what the drive can do
  double delay_s = 0.0;  ///< latency and lag together
};

/// Fastest speed towards the leader, along the line of sight, from which the robot can still keep d_min: negative where
/// it must reverse, because the leader comes nearer or is too near already.
double guarded_speed(const GuardConfig& config, const Reaction& reaction, const LeaderMotion& leader) noexcept;

/// The same as a bound on the robot's forward speed, with the leader at a bearing.
double guarded_forward_speed(const GuardConfig& config, const Reaction& reaction, const LeaderMotion& leader) noexcept;

}  // namespace pilotfish::control
PILOTFISH_API_END
