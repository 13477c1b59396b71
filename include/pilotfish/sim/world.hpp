#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/range_scan.hpp"
#include "pilotfish/sim/scenario.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// Time zero of every world on the frames' clock [us]: not zero, which elsewhere means "never".
inline constexpr std::int64_t kStartUtime = 1'000'000;

/// The world of a scenario. It has no clock: it is advanced. It has no hidden randomness: noise, clutter and
/// dropped frames are functions of (seed, name of the robot, number of the frame), so one robot's pictures
/// do not depend on the other cameras. The same commands give the same bytes.
///
/// A robot's name that the scenario does not have is a std::out_of_range: a mistake of the caller, not of the run.
class World {
 public:
  /// Throws ConfigError if the scenario is not valid.
  explicit World(Scenario scenario);
  World(const World&) = delete;
  World(World&&) = default;  ///< not copied: it is large

  const Scenario& scenario() const { return scenario_; }  ///< the scenario
  double time_s() const { return time_s_; }               ///< 0 at the start
  std::int64_t utime() const;                             ///< the same on the frames' clock [us]
  /// Number of the exposure that belongs to the present time: round(time * rate).
  std::int64_t frame_index() const;

  /// From effective_time_s on this is the robot's command, until a newer one takes effect. A time in the past
  /// means now. Refused (false): a twist or time that is not finite, or a robot that drives a trajectory.
  bool command(const std::string& robot, const Twist& twist, double effective_time_s);
  /// Advances all robots. A time in the past, or one that is not finite or beyond kNever_s, changes nothing.
  void advance_to(double time_s);

  /// From the exposure of the robot's present picture until the command that answers it acts [s].
  double latency_s(const std::string& robot) const;

  /// A robot's pose and twist now.
  UnicycleState state(const std::string& robot) const;
  /// The command in effect at a time that is not in the past, if no other arrives before.
  Twist command_in_effect(const std::string& robot, double time_s) const;

  /// Of the robot that `robot` follows, at this instant: its base in the camera's frame, and its distance,
  /// bearing and heading from the follower's base.
  Eigen::Isometry3d true_cMo(const std::string& robot) const;
  /// The same as distance, bearing and heading.
  RelativePose true_relative_pose(const std::string& robot) const;

  /// What its range sensors read now; nothing between two rounds. Obstacles and the other robots' outlines are what
  /// there is to see. std::out_of_range: a robot without any.
  std::optional<RangeScan> ranges(const std::string& robot) const;
  /// From its outline to the nearest obstacle or other robot's outline, now [m]; below 0 they collide. Infinite: alone.
  double clearance_m(const std::string& robot) const;
  /// Whether a tag of the robot that `robot` follows is in sight of its camera: turned to it, and whole, behind no
  /// obstacle and no other robot. Its place in the picture does not matter.
  bool leader_in_sight(const std::string& robot) const;
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }  ///< also those drawn at random

  /// The robot's camera picture now; nothing if the scenario's seed drops this frame.
  std::optional<Frame> capture(const std::string& robot) const;

 private:
  struct Pending {
    double time_s = 0.0;
    Twist twist;
  };
  struct Robot {
    const RobotSpec* spec = nullptr;
    Unicycle unicycle{DriveConfig{}};
    std::deque<Pending> pending;  ///< by time
    Pending in_effect;            ///< since when, and which
    std::vector<Surface> surfaces;
    std::optional<Renderer> renderer;
  };

  const Robot& robot(const std::string& name) const;
  const Robot& leader_of(const Robot& follower) const;
  UnicycleState state_near_now(const Robot& robot, double offset_s) const;
  static const CameraSpec& camera_of(const Robot& robot);
  std::uint64_t frame_seed(const Robot& robot, const char* purpose) const;
  Eigen::Isometry3d camera_in_world(const Robot& robot, double offset_s) const;
  View view(const Robot& robot, double offset_s) const;
  std::vector<Obstacle> around(const Robot& robot, const Robot* without) const;
  void drive(Robot& robot, double until_s) const;

  Scenario scenario_;
  std::map<std::string, Robot> robots_;
  std::vector<Obstacle> obstacles_;
  std::vector<std::vector<Surface>> obstacle_surfaces_;
  double time_s_ = 0.0;
};

/// World from base: a pose on the ground as a pose in space.
Eigen::Isometry3d world_from_base(const Pose2& pose);

}  // namespace pilotfish::sim
PILOTFISH_API_END
