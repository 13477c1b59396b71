// What a Follower does with ranges: obstacles around it, the last bound of its speed, and the search of a lost leader.
#include <algorithm>
#include <cmath>

#include "pilotfish/control/follower.hpp"
#include "pilotfish/control/range_guard.hpp"
#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {

bool Follower::set_ranges(const RangeScan& scan) noexcept {
  if (!config_.avoidance.enabled || !is_usable(scan)) return false;
  if (ranges_.utime() && scan.utime <= *ranges_.utime()) return false;
  ranges_.add(scan, own_.twist(), own_.utime());
  return true;
}

void Follower::advance_own_to(std::int64_t utime) noexcept {
  const Pose2 before = own_.pose();
  own_.advance_to(utime);
  if (config_.avoidance.enabled) ranges_.moved(before, own_.pose());
}

/// Where the robot is and how fast when the command acts, as the collision guard has it.
Twist Follower::within_ranges(const Twist& command, std::int64_t utime, AvoidanceOutput& output) const noexcept {
  const AvoidanceConfig& config = config_.avoidance;
  const std::int64_t acts = acts_utime(utime);
  EgoMotion then = own_;
  then.advance_to(acts);
  const ObstacleView view = ranges_.view(reading_model(config), utime, motion_between(own_.pose(), then.pose()));
  output.nearest_m = config.max_range_m;
  for (const SurfacePoint& point : view.points)
    output.nearest_m = std::min(output.nearest_m, std::hypot(point.x_m, point.y_m) - config.robot_radius_m);
  Twist allowed = command;
  allowed.linear_mps = guarded_by_ranges(config, {config_.limits, config_.hold_s, actuator_lag_s_}, view, command,
                                         then.twist(), std::max(seconds_between(*ranges_.utime(), acts), 0.0));
  output.allowed_mps = allowed.linear_mps;
  output.limited = allowed.linear_mps != command.linear_mps;
  return allowed;
}

SearchOutput Follower::search(std::int64_t utime) noexcept {
  if (!config_.search.search_by_rotating) return {};
  advance_own_to(utime);
  const AvoidanceConfig& config = config_.avoidance;
  if (!ranges_.fresh_at(utime, config.max_age_s)) return {false, Reason::ranges_not_fresh, 0.0};
  const ObstacleView view = ranges_.view(reading_model(config), utime);
  if (!view.covered.all()) return {false, Reason::ranges_not_fresh, 0.0};
  for (const SurfacePoint& point : view.points)
    if (std::hypot(point.x_m, point.y_m) <= config.robot_radius_m) return {false, Reason::obstacle_in_path, 0.0};
  const double turn_radps = search_.turn_rate(utime, ranges_.heading_rad());
  own_.command({0.0, turn_radps}, acts_utime(utime));
  searched_utime_ = utime;
  if (turn_radps == 0.0) return {};
  return {true, Reason::turning_to_search, turn_radps};
}

}  // namespace pilotfish::control
