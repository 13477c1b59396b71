#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/sim/obstacle.hpp"
#include "pilotfish/sim/range_sensors.hpp"
#include "pilotfish/sim/renderer.hpp"
#include "pilotfish/sim/robot_body.hpp"
#include "pilotfish/sim/trajectory.hpp"
#include "pilotfish/sim/unicycle.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// When a robot is invisible: for scenes in which the leader disappears, or is covered for a while.
struct Visibility {
  PILOTFISH_PARAMETERS(Visibility);
  PILOTFISH_PARAMETER(double, hidden_from_s, kNever_s, 0.0, kNever_s, "from then on it is invisible");
  PILOTFISH_PARAMETER(double, hidden_until_s, kNever_s, 0.0, kNever_s, "from then on it is visible again");
  /// False while it is hidden.
  bool visible_at(double time_s) const { return time_s < hidden_from_s || time_s >= hidden_until_s; }
};

/// A robot's own camera. The errors are unknown to the coordinator: the world has them, no configuration does.
struct CameraSpec {
  CameraModel model;            ///< size and lens
  CameraMounting mounting;      ///< where it sits on the robot
  Imperfections imperfections;  ///< Imperfections of its pictures
  PILOTFISH_PARAMETERS(CameraSpec);
  PILOTFISH_PARAMETER(double, latency_s, 1.0 / 30.0, 0.0, 2.0,
                      "from the exposure until the command that answers it acts");
  PILOTFISH_PARAMETER(double, latency_jitter_s, 0.0, 0.0, 1.0, "each picture's latency is drawn evenly within +- this");
  PILOTFISH_PARAMETER(double, drop_probability, 0.0, 0.0, 1.0, "of a picture never being delivered");
  PILOTFISH_PARAMETER(double, vibration_rad, 0.0, 0.0, 0.1,
                      "standard deviation of pitch and of roll, drawn anew for every picture");
  PILOTFISH_PARAMETER(double, pan_error_rad, 0.0, -0.2, 0.2,
                      "the camera really looks so much farther left than mounting says");
  PILOTFISH_PARAMETER(double, tilt_error_rad, 0.0, -0.2, 0.2, "and so much farther up");
  PILOTFISH_PARAMETER(double, focal_error, 0.0, -0.1, 0.1,
                      "its focal length is really so much longer than the calibration's, as a share");
};

CameraModel real_model(const CameraSpec& camera);        ///< with the error unknown to the coordinator
CameraMounting real_mounting(const CameraSpec& camera);  ///< likewise

/// One robot of the world. It does one of three: it drives a trajectory, it follows another robot by
/// vision, or, with neither, it executes the commands that it receives.
struct RobotSpec {
  std::string name;                           ///< name of the robot: its channels and its noise come from it
  Pose2 start;                                ///< Pose2 at time 0 in the world frame
  std::optional<Trajectory> trajectory;       ///< otherwise it follows another or executes commands
  std::string follows;                        ///< name of the robot it follows; empty if none
  DriveConfig drive;                          ///< limits of its drive
  std::optional<RobotBody> body;              ///< its appearance; nothing if it has none
  Visibility visibility;                      ///< when it is visible
  std::optional<CameraSpec> camera;           ///< CameraSpec, or nothing if it has no camera
  std::filesystem::path coordinator_file;     ///< configuration of the coordinator that drives it; not read here
  std::optional<Setpoint> setpoint;           ///< for that coordinator, in place of its file's
  double radius_m = kDefaultRadius_m;         ///< of the circle around its base origin that is its outline
  std::optional<RangeSensors> range_sensors;  ///< RangeSensors, or nothing if it has none

  static constexpr double kDefaultRadius_m = 0.25, kMaxRadius_m = 5.0;  ///< [m]
};

/// A world to simulate: robots, time, seed. See data/scenarios/.
struct Scenario {
  PILOTFISH_PARAMETERS(Scenario);
  PILOTFISH_PARAMETER_WITHOUT_RANGE(std::string, name, {}, "one word, for file names");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(std::string, description, {}, "for display");
  PILOTFISH_PARAMETER(double, duration_s, 20.0, 0.01, 1e5, "of the run");
  PILOTFISH_PARAMETER(double, frame_rate_hz, 30.0, 1.0, 1000.0, "of all cameras; they expose together");
  PILOTFISH_PARAMETER(int, seed, 1, 0, 2147483647, "of noise, clutter and dropped frames");
  std::vector<RobotSpec> robots;                ///< list of RobotSpec; getting it gives a copy, so set it as a whole
  std::vector<Obstacle> obstacles;              ///< list of Obstacle, a copy as well
  std::optional<ObstacleField> obstacle_field;  ///< more of them, drawn at random

  const RobotSpec* find(const std::string& robot) const;  ///< nullptr if there is none of that name
  int frame_count() const;                                ///< exposures at k / frame_rate_hz, k = 0, 1, ... < duration
  /// `obstacles`, and those of the field. Throws ConfigError if these do not fit.
  std::vector<Obstacle> all_obstacles() const;
  /// Throws ConfigError ("robots[1].follows: ..."): names, what follows what, what that needs, ranges.
  void validate() const;
};

}  // namespace pilotfish::sim
PILOTFISH_API_END
