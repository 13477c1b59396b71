#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/control/fuzzy_velocity_law.hpp"
#include "pilotfish/control/leader_motion_estimator.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// The paper's law around a feed-forward of the leader's motion. It acts on a predicted error, free of the delay of the
/// camera and the wheels, and can therefore be steeper than the law as published: hence its own scales.
struct AnticipateConfig {
  PILOTFISH_PARAMETERS(AnticipateConfig);
  PILOTFISH_PARAMETER(double, error_scale_m, 0.28, 0.01, 20.0,
                      "predicted distance error that is 1 on the universe of e");
  PILOTFISH_PARAMETER(double, error_change_scale_m, 0.1, 1e-4, 5.0,
                      "predicted change of the error per control period that is 1 on the universe of ec");
  PILOTFISH_PARAMETER(double, velocity_scale_mps, 0.6, 0.01, 5.0,
                      "speed relative to the leader commanded at 1 on the universe of u");
  PILOTFISH_PARAMETER(double, heading_gain_per_s, 6.0, 0.0, 20.0, "turn rate per radian of predicted bearing error");
  PILOTFISH_PARAMETER(double, half_weight_sigma_mps, 0.1, 1e-3, 10.0,
                      "standard deviation of the leader's velocity at which the feed-forward weight is 1/2");
  /// See keep_in_view().
  PILOTFISH_PARAMETER(double, guard_time_s, 0.5, 0.05, 5.0,
                      "the leader may not approach the picture's edge faster than this");
  /// See eased_speed().
  PILOTFISH_PARAMETER(double, ease_time_s, 0.1, 0.0, 2.0,
                      "time constant with which the top speed is approached; 0: none");
};

/// Bearings at which the leader is in the picture; from the camera and its mounting.
struct FieldOfView {
  double right_rad = -3.14159265358979323846;  ///< the picture's right edge [rad], negative ahead
  double left_rad = 3.14159265358979323846;    ///< the picture's left edge [rad], positive ahead
};

/// The feed-forward weight of the leader's estimated velocity: 1 / (1 + (sigma / half_weight_sigma_mps)^2), in (0, 1].
double feed_forward_weight(const AnticipateConfig& config, const LeaderMotion& leader) noexcept;

/// The wanted twist for the leader as predicted for the moment at which the command has taken effect; `own` is the
/// twist of the robot at that moment under unchanged commands. Not yet limited.
struct Anticipation {
  Twist wanted;              ///< output of the law; not yet limited
  VelocityCommand velocity;  ///< the fuzzy law on the predicted error
};
Anticipation anticipate(const fuzzy::Controller& controller, const FuzzyVelocityConfig& paper,
                        const AnticipateConfig& config, const LeaderMotion& leader, const Twist& own,
                        const Setpoint& setpoint);

/// Fastest speed a time dt_s after `previous_mps` that approaches the top speed smoothly. Slowing down is never
/// delayed.
double eased_speed(const AnticipateConfig& config, const LimitsConfig& limits, double previous_mps,
                   double dt_s) noexcept;

/// The nearest twist to `wanted` with which the leader, as predicted, approaches the edge of the picture no faster
/// than would reach it in guard_time_s.
Twist keep_in_view(const AnticipateConfig& config, const FieldOfView& view, const LimitsConfig& limits,
                   const LeaderMotion& leader, const Twist& wanted) noexcept;

}  // namespace pilotfish::control
PILOTFISH_API_END
