#pragma once

#include <variant>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/sim/unicycle.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// A predetermined trajectory. The pose of a robot that has one is at any time exactly the formula's,
/// so that the truth in a report is the scenario's own. It starts where the robot starts and in the
/// direction it faces.

inline constexpr double kNever_s = 1e9;

/// Speed along a path: from rest at start_time_s up to speed_mps with a constant acceleration, and from
/// stop_time_s down to rest again. A negative speed drives backwards.
struct SpeedProfile {
  PILOTFISH_PARAMETERS(SpeedProfile);
  PILOTFISH_PARAMETER(double, speed_mps, 0.2, -5.0, 5.0, "negative: backwards");
  PILOTFISH_PARAMETER(double, acceleration_mps2, 0.5, 1e-3, 1e3, "from rest to speed, and back to rest");
  PILOTFISH_PARAMETER(double, start_time_s, 0.0, 0.0, kNever_s, "stands still until then");
  PILOTFISH_PARAMETER(double, stop_time_s, kNever_s, 0.0, kNever_s, "brakes from then on");
};

/// Distance covered and speed at a time. With T = min(t, stop) - start the time spent driving:
///   rising  s = a T^2 / 2 until v/a,  steady  s = v (T - v / 2a),  braking  s = s_stop + v_stop u - a u^2 / 2.
struct Progress {
  double distance_m = 0.0;  ///< along the path [m]
  double speed_mps = 0.0;   ///< along the path [m/s]
};
Progress progress_at(const SpeedProfile& profile, double time_s);

struct Still {};

/// Straight ahead.
struct Line {
  SpeedProfile profile;  ///< SpeedProfile along the line
};

/// A circular arc.
struct Circle {
  PILOTFISH_PARAMETERS(Circle);
  PILOTFISH_PARAMETER(double, radius_m, 1.0, 0.05, 1e3, "of the path of its turning centre");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, clockwise, false, "false: turns to the left");
  SpeedProfile profile;  ///< SpeedProfile along the arc
};

/// Gerono's lemniscate, x = a sin p, y = b sin p cos p, driven at constant speed along its arc: it crosses
/// itself at the start, and its curvature is continuous (zero at the crossing), so that a real robot could drive it.
struct FigureEight {
  PILOTFISH_PARAMETERS(FigureEight);
  /// The a of the curve.
  PILOTFISH_PARAMETER(double, half_length_m, 1.5, 0.05, 1e3, "from the crossing to the far end of a lobe");
  /// The b of the curve.
  PILOTFISH_PARAMETER(double, half_width_m, 1.0, 0.05, 1e3, "width of a lobe");
  SpeedProfile profile;  ///< SpeedProfile along the arc
};
double lap_length_m(const FigureEight& eight);

/// One point to drive to, in the frame of the start pose (x ahead, y left).
struct Waypoint {
  PILOTFISH_PARAMETERS(Waypoint);
  PILOTFISH_PARAMETER(double, x_m, 0.0, -1e4, 1e4, "ahead of the start");
  PILOTFISH_PARAMETER(double, y_m, 0.0, -1e4, 1e4, "to the left of the start");
  PILOTFISH_PARAMETER(double, pause_s, 0.0, 0.0, 1e6, "stands still there before going on");
};

/// Turns on the spot towards the next point, drives there in a straight line, stops, waits. Every move starts
/// and ends at rest with a trapezoidal speed.
struct Waypoints {
  std::vector<Waypoint> points;  ///< list of Waypoint; getting it gives a copy, so set it as a whole
  PILOTFISH_PARAMETERS(Waypoints);
  PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, repeat, false, "after the last point go to the first one again");
  PILOTFISH_PARAMETER(double, speed_mps, 0.2, 1e-3, 5.0, "top speed between two points");
  PILOTFISH_PARAMETER(double, acceleration_mps2, 0.5, 1e-3, 1e3, "from rest to speed, and back to rest");
  PILOTFISH_PARAMETER(double, turn_rate_radps, 0.5, 1e-3, 50.0, "top turn rate on the spot");
  PILOTFISH_PARAMETER(double, turn_acceleration_radps2, 1.0, 1e-3, 1e4, "of a turn on the spot");
  PILOTFISH_PARAMETER(double, start_time_s, 0.0, 0.0, kNever_s, "stands still until then");
};

using Trajectory = std::variant<Still, Line, Circle, FigureEight, Waypoints>;

/// Pose and twist at a time >= 0 on the trajectory that begins at `start`.
UnicycleState state_at(const Trajectory& trajectory, const Pose2& start, double time_s);

}  // namespace pilotfish::sim
PILOTFISH_API_END
