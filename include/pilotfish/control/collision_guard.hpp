#pragma once

#include "pilotfish/api.hpp"
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
  PILOTFISH_PARAMETER(double, leader_deceleration_mps2, 0.0, 0.0, 100.0,
                      "the hardest that the leader brakes; 0: it may stop dead. Not less than "
                      "control.limits.max_linear_acceleration_mps2");
};

/// The drive: its limits, its lag, and how long a command acts before the next one can.
struct Reaction {
  LimitsConfig limits;          ///< what the drive can do
  double hold_s = 0.0;          ///< safety.max_age_s, so that the last picture may be the last for ever
  double actuator_lag_s = 0.0;  ///< with which the wheels follow
};

/// The gap to the leader at the moment at which the command acts, if the leader brakes as hard as it can from the
/// exposure on.
struct Gap {
  double distance_m = 0.0;        ///< to where the leader was at the exposure; less what it has come nearer since
  double bearing_rad = 0.0;       ///< of that place
  double distance_sigma_m = 0.0;  ///< standard deviation of the distance
  double own_mps = 0.0;           ///< the robot's real speed then, as if it led to the leader
  double set_mps = 0.0;           ///< and its drive's set value, which follows a command with the acceleration
  double leaving_mps = 0.0;       ///< the leader's speed away, as surely as it is known; below 0: it comes
};

/// Fastest speed towards the leader, along the line of sight, from which the robot can still keep d_min: negative where
/// it must reverse, because the leader comes nearer or is too near already.
double guarded_speed(const GuardConfig& config, const Reaction& reaction, const Gap& gap) noexcept;

/// The same as a bound on the robot's forward speed, with the leader at a bearing.
double guarded_forward_speed(const GuardConfig& config, const Reaction& reaction, const Gap& gap) noexcept;

}  // namespace pilotfish::control
PILOTFISH_API_END
