#pragma once

#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/control/anticipating_law.hpp"
#include "pilotfish/control/range_field.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/fuzzy/rule_base.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// Obstacles, as sonars or a laser measure them: passed on the free side, and never run into. See docs/obstacles.md.
struct AvoidanceConfig {
  PILOTFISH_PARAMETERS(AvoidanceConfig);
  PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, enabled, false,
                                    "true: passes obstacles that the ranges show, and does not drive without fresh "
                                    "ranges; false: ranges are ignored");
  PILOTFISH_PARAMETER(double, robot_radius_m, 0.25, 0.02, 5.0,
                      "of the circle around the base origin that contains the robot");
  PILOTFISH_PARAMETER(double, margin_m, 0.05, 0.0, 2.0,
                      "between that circle and what the ranges show, always: more than the error of a reading");
  PILOTFISH_PARAMETER(double, passing_m, 0.07, 0.0, 2.0, "and besides, where an obstacle is passed on purpose");
  PILOTFISH_PARAMETER(
      double, cone_rad, radians(15.0), 0.0, radians(90.0),
      "full opening of one reading; not less than the step between two, or what lies between is unknown "
      "and the robot does not drive there; a laser: 0");
  PILOTFISH_PARAMETER(double, max_range_m, 3.0, 0.1, 100.0,
                      "a reading at or above says that nothing is nearer than this");
  PILOTFISH_PARAMETER(double, max_age_s, 0.15, 0.01, 0.5, "ranges older than this move nothing");
  PILOTFISH_PARAMETER(double, look_ahead_m, 1.2, 0.1, 20.0, "an obstacle farther ahead is not yet passed");
  PILOTFISH_PARAMETER(double, max_shift_rad, radians(60.0), radians(1.0), radians(90.0),
                      "the bearing that is kept is shifted by less than this; 1 on the universes of E and U");
  PILOTFISH_PARAMETER(double, shift_time_s, 0.15, 0.0, 5.0, "time constant with which that shift grows");
  PILOTFISH_PARAMETER(double, return_time_s, 0.4, 0.0, 5.0, "time constant with which it is given back");
  PILOTFISH_PARAMETER(double, sight_m, 0.2, 0.0, 2.0,
                      "obstacles are kept so far from the line of sight to the leader, where that is possible");
  PILOTFISH_PARAMETER(
      double, leader_radius_m, 0.30, 0.0, 5.0,
      "of the circle around the leader's base origin that contains it: what the ranges show of it is not "
      "passed, but never run into");
  PILOTFISH_PARAMETER(double, creep_mps, 0.08, 0.0, 5.0,
                      "where there is less room than passing_m it drives no faster than this, to have time to turn");
  PILOTFISH_PARAMETER(double, blocked_s, 1.0, 0.0, 60.0,
                      "a robot that has stood before an obstacle for so long backs off, as far as the ranges allow");
  PILOTFISH_PARAMETER(double, back_off_m, 0.25, 0.0, 5.0, "by this; 0: it stays where it is");
  PILOTFISH_PARAMETER(double, back_off_mps, 0.12, 0.01, 5.0,
                      "with this speed; control.limits.max_reverse_mps bounds it");
  PILOTFISH_PARAMETER(double, obstacle_speed_mps, 0.0, 0.0, 5.0,
                      "with which an obstacle may come nearer; 0: obstacles stand");
};

/// The reading's model in that section.
RangeReadingModel reading_model(const AvoidanceConfig& config) noexcept;

/// The 56 rules: E, how far to the side of the wanted direction the free one is; EC, how near the obstacle; U, by how
/// much the bearing that is kept is shifted. data/fuzzy/avoidance.yaml has the same, in words.
fuzzy::Controller avoidance_rules();

/// What was made of the ranges in one step.
struct AvoidanceOutput {
  double bearing_shift_rad = 0.0;   ///< of the bearing that is kept; positive: the robot drives farther to the left
  double free_way_m = 0.0;          ///< in the direction in which the law alone would drive; look_ahead_m at most
  double free_direction_rad = 0.0;  ///< that was chosen, in the base frame
  double nearest_m = 0.0;           ///< from the robot's circle to the nearest surface; max_range_m if there is none
  double allowed_mps = 0.0;         ///< bound of the speed: the robot can stop before what the ranges show in its path
  bool limited = false;             ///< that bound was below what the law wanted
  bool backing_off = false;         ///< it was blocked, and makes room to turn
};

/// Passes obstacles by shifting the bearing at which the leader is kept: the robot then drives beside the direction in
/// which the law alone would, and the law (any of them) keeps doing everything else. The leader stays in the picture,
/// because the shift ends where it would leave it.
class Avoidance {
 public:
  explicit Avoidance(const AvoidanceConfig& config);  ///< nothing has been passed yet

  /// Where the leader was measured and how large it may be: what the ranges show of it is not to be passed.
  Disc leader(const Observation& observation) const noexcept;
  /// The setpoint with the bearing to keep now. `view`: without the leader. `heading_rad`: of the robot, in any frame
  /// that stays; dt_s since the step before.
  Setpoint steer(const ObstacleView& view, const Observation& observation, const Setpoint& setpoint,
                 const FieldOfView& field_of_view, double heading_rad, double dt_s, AvoidanceOutput& output) noexcept;
  /// The law's twist, slower where there is little room, or backwards where the robot was blocked. `own`: its twist.
  Twist moderate(const ObstacleView& view, const Twist& wanted, const Twist& own, double acceleration_mps2, double dt_s,
                 AvoidanceOutput& output) noexcept;
  /// The ranges allowed that speed of `wanted_mps`, for the next dt_s.
  void allowed(double allowed_mps, double wanted_mps, double dt_s) noexcept;
  void restart() noexcept;  ///< the robot stands

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.shift_rad_, self.chosen_heading_rad_, self.blocked_s_, self.backing_m_, self.backing_s_);
  }

 private:
  AvoidanceConfig config_;
  fuzzy::Controller rules_;
  double shift_rad_ = 0.0;
  double blocked_s_ = 0.0;                    ///< for so long the ranges have allowed no way ahead
  double backing_m_ = 0.0, backing_s_ = 0.0;  ///< still to back off, for this time at most
  std::optional<double> chosen_heading_rad_;  ///< of the free direction, so that the robot keeps to a side
};

}  // namespace pilotfish::control
PILOTFISH_API_END
