#pragma once

#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// A pose on the ground.
struct Pose2 {
  PILOTFISH_PARAMETERS(Pose2);
  PILOTFISH_PARAMETER(double, x_m, 0.0, -1e4, 1e4, "in the world frame");
  PILOTFISH_PARAMETER(double, y_m, 0.0, -1e4, 1e4, "in the world frame");
  /// In (-pi, pi].
  PILOTFISH_PARAMETER(double, heading_rad, 0.0, -2 * kPi, 2 * kPi, "0 along the world's x axis, positive to the left");
};

/// sin(a) / a, and 1 at zero.
double sinc(double a);

/// The pose after moving with a constant twist for dt_s: exactly, along the arc.
///
///   x += v dt sinc(w dt / 2) cos(heading + w dt / 2),  y likewise with sin,  heading += w dt
///
/// since the chord of an arc of length v dt and angle w dt has length v dt sinc(w dt / 2), sinc(a) = sin(a) /
/// a, and the direction half way. No case distinction between straight and turning is needed.
Pose2 move_along_arc(const Pose2& pose, const Twist& twist, double dt_s);

/// One axis of a drive: the measured speed v behind the driver's set value r, which ramps to `target` with at most
/// max_acceleration and is followed with a first-order lag tau:
///
///   dr/dt = +-a until r reaches the target,   dv/dt = (r - v) / tau
///
/// Moves both on by t, in closed form, and returns the integral of v over t.
double follow_set_value(double& v, double& r, double target, double max_acceleration, double tau, double t);

}  // namespace pilotfish
PILOTFISH_API_END
