#pragma once

#include <variant>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/sim/unicycle.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// A predetermined trajectory. Robots that have one are on rails: their pose at any time is the formula's,
/// exactly, so that the truth in a report is the scenario's own. It starts where the robot starts and in the
/// direction it faces.

inline constexpr double kNever_s = 1e9;

/// Speed along a path: from rest at start_time_s up to speed_mps with a constant acceleration, and from
/// stop_time_s down to rest again. A negative speed drives backwards.
struct SpeedProfile {
  double speed_mps = 0.2;
  double acceleration_mps2 = 0.5;
  double start_time_s = 0.0;
  double stop_time_s = kNever_s;
  static const std::vector<Parameter<SpeedProfile>>& parameters();
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
  double radius_m = 1.0;   ///< [m], of the base's origin
  bool clockwise = false;  ///< false: turns to the left
  SpeedProfile profile;    ///< SpeedProfile along the arc
  static const std::vector<Parameter<Circle>>& parameters();
};

/// Gerono's lemniscate, x = a sin p, y = b sin p cos p, driven at constant speed along its arc: it crosses
/// itself at the start, and its curvature is continuous (zero at the crossing), so that a real robot could drive it.
struct FigureEight {
  double half_length_m = 1.5;  ///< a: from the crossing to the far end of a lobe
  double half_width_m = 1.0;   ///< b: a lobe is as wide as b
  SpeedProfile profile;        ///< SpeedProfile along the arc
  static const std::vector<Parameter<FigureEight>>& parameters();
};
double lap_length_m(const FigureEight& eight);

/// One point to drive to, in the frame of the start pose (x ahead, y left).
struct Waypoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double pause_s = 0.0;  ///< standing still there before going on
  static const std::vector<Parameter<Waypoint>>& parameters();
};

/// Turns on the spot towards the next point, drives there in a straight line, stops, waits. Every move starts
/// and ends at rest with a trapezoidal speed.
struct Waypoints {
  std::vector<Waypoint> points;  ///< list of Waypoint; getting it gives a copy, so set it as a whole
  bool repeat = false;           ///< after the last point go to the first one again
  double speed_mps = 0.2;
  double acceleration_mps2 = 0.5;
  double turn_rate_radps = 0.5;
  double turn_acceleration_radps2 = 1.0;
  double start_time_s = 0.0;
  static const std::vector<Parameter<Waypoints>>& parameters();
};

using Trajectory = std::variant<Still, Line, Circle, FigureEight, Waypoints>;

/// Pose and twist at a time >= 0 on the trajectory that begins at `start`.
UnicycleState state_at(const Trajectory& trajectory, const Pose2& start, double time_s);

}  // namespace pilotfish::sim
PILOTFISH_API_END
