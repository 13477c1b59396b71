#include "pilotfish/control/avoidance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pilotfish/control/free_way.hpp"
#include "pilotfish/fuzzy/mamdani.hpp"

namespace pilotfish::control {
namespace {

constexpr double kFan_rad = radians(3.0);         // between two directions that are compared
constexpr double kEdge_rad = radians(5.0);        // half a tag at a metre: nearer to the edge of the picture it is cut
constexpr double kSidewards_rad = radians(90.0);  // the law drives ahead, never back
constexpr double kPreview_m = 0.4;                // after which the line of sight is looked at
constexpr double kGentle = 0.3;                   // of the drive's acceleration
constexpr double kStands_mps = 0.01;              // slower is standing
constexpr double kTurnCost = 0.35, kSwitchCost = 0.15, kSightCost = 0.5, kNearCost = 2.0;  // over that of a blocked way

double distance_m(const SurfacePoint& a, const SurfacePoint& b) noexcept {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

SurfacePoint at(double distance_m, double direction_rad) noexcept {
  return {distance_m * std::cos(direction_rad), distance_m * std::sin(direction_rad)};
}

/// From a point to the straight line between two others.
double distance_to_line_m(const SurfacePoint& point, const SurfacePoint& from, const SurfacePoint& to) noexcept {
  const double x = to.x_m - from.x_m, y = to.y_m - from.y_m, length2 = x * x + y * y;
  const double along = length2 > 0.0 ? ((point.x_m - from.x_m) * x + (point.y_m - from.y_m) * y) / length2 : 0.0;
  const double t = std::clamp(along, 0.0, 1.0);
  return distance_m(point, {from.x_m + t * x, from.y_m + t * y});
}

/// What is near enough to matter.
ObstacleView within(const ObstacleView& view, double reach_m) noexcept {
  ObstacleView near;
  for (const SurfacePoint& point : view.points)
    if (std::hypot(point.x_m, point.y_m) < reach_m) near.points.push_back(point);
  return near;
}

/// How straight that direction leads towards a surface that is nearer than the radius already: the cosine. Every way
/// that leads nearer ends at once there, so the ways alone would not tell one direction from another.
double approach(const ObstacleView& view, double direction_rad, double radius_m) noexcept {
  double most = 0.0;
  for (const SurfacePoint& point : view.points) {
    const double range_m = std::hypot(point.x_m, point.y_m);
    if (range_m >= radius_m || range_m <= 0.0) continue;
    const double towards_m = point.x_m * std::cos(direction_rad) + point.y_m * std::sin(direction_rad);
    most = std::max(most, towards_m / range_m);
  }
  return most;
}

/// 0: nothing comes near the line of sight; 1: it is crossed. After the robot has gone kPreview_m in that direction and
/// the leader as far in its own.
double sight_blocked(const ObstacleView& view, const AvoidanceConfig& config, const Observation& observation,
                     double direction_rad) noexcept {
  if (!(config.sight_m > 0.0)) return 0.0;
  const SurfacePoint own = at(kPreview_m, direction_rad), gone = at(kPreview_m, observation.heading_rad);
  SurfacePoint leader = at(observation.distance_m, observation.bearing_rad);
  leader.x_m += gone.x_m;
  leader.y_m += gone.y_m;
  double nearest_m = config.sight_m;
  for (const SurfacePoint& point : view.points) nearest_m = std::min(nearest_m, distance_to_line_m(point, own, leader));
  return 1.0 - nearest_m / config.sight_m;
}

fuzzy::LinguisticVariable variable(const char* name, std::vector<fuzzy::Term> terms) {
  return {name, -1.0, 1.0, std::move(terms)};
}

}  // namespace

RangeReadingModel reading_model(const AvoidanceConfig& config) noexcept {
  return {config.cone_rad, config.max_range_m, config.max_age_s};
}

fuzzy::Controller avoidance_rules() {
  using fuzzy::Trapezoid, fuzzy::Triangle;
  constexpr double kInf = std::numeric_limits<double>::infinity();
  fuzzy::Controller rules;
  rules.name = "avoidance";
  rules.error = variable("E", {{"NB", Trapezoid{-kInf, -kInf, -0.9, -0.6}},
                               {"NM", Triangle{-0.9, -0.6, -0.3}},
                               {"NS", Triangle{-0.6, -0.3, -0.1}},
                               {"NZ", Triangle{-0.3, -0.1, 0.05}},
                               {"PZ", Triangle{-0.05, 0.1, 0.3}},
                               {"PS", Triangle{0.1, 0.3, 0.6}},
                               {"PM", Triangle{0.3, 0.6, 0.9}},
                               {"PB", Trapezoid{0.6, 0.9, kInf, kInf}}});
  rules.error_change = variable("EC", {{"NB", Trapezoid{-kInf, -kInf, -1.0, -0.7}},
                                       {"NM", Triangle{-1.0, -0.7, -0.35}},
                                       {"NS", Triangle{-0.7, -0.35, 0.0}},
                                       {"ZE", Triangle{-0.35, 0.0, 0.35}},
                                       {"PS", Triangle{0.0, 0.35, 0.7}},
                                       {"PM", Triangle{0.35, 0.7, 1.0}},
                                       {"PB", Trapezoid{0.7, 1.0, kInf, kInf}}});
  rules.output = variable("U", {{"NB", Triangle{-1.25, -1.0, -0.75}},
                                {"NM", Triangle{-0.9, -0.6, -0.3}},
                                {"NS", Triangle{-0.6, -0.3, 0.0}},
                                {"ZE", Triangle{-0.1, 0.0, 0.1}},
                                {"PS", Triangle{0.0, 0.3, 0.6}},
                                {"PM", Triangle{0.3, 0.6, 0.9}},
                                {"PB", Triangle{0.75, 1.0, 1.25}}});
  constexpr std::size_t NB = 0, NM = 1, NS = 2, ZE = 3, PS = 4, PM = 5, PB = 6;
  rules.rules.rows = fuzzy::kPaperRows;
  rules.rules.columns = fuzzy::kPaperColumns;
  rules.rules.consequents = {
      // far ...            ... near
      ZE, NM, NB, NB, NB, NB, NB,  // far to the right
      ZE, NS, NM, NM, NB, NB, NB,  //
      ZE, NS, NS, NS, NM, NM, NM,  //
      ZE, ZE, NS, NS, NS, NS, NS,  // just to the right
      ZE, ZE, PS, PS, PS, PS, PS,  // just to the left
      ZE, PS, PS, PS, PM, PM, PM,  //
      ZE, PS, PM, PM, PB, PB, PB,  //
      ZE, PM, PB, PB, PB, PB, PB,  // far to the left
  };
  fuzzy::validate(rules);
  return rules;
}

Avoidance::Avoidance(const AvoidanceConfig& config) : config_(config) {
  if (config.enabled) rules_ = avoidance_rules();
}

Disc Avoidance::leader(const Observation& observation) const noexcept {
  const SurfacePoint centre = at(observation.distance_m, observation.bearing_rad);
  return {centre.x_m, centre.y_m, config_.leader_radius_m};
}

/// Alone, the law turns the robot until the leader is at the wanted bearing: by theta - theta_pd, the wanted direction.
/// A fan of directions, all those in which the leader stays in the picture (turning by phi moves it by -phi), is
/// compared: what it costs to go there is a blocked way, a turn away from the wanted direction, a change of the side
/// chosen before, and a blocked line of sight. The rules say how much of the turn to the best one is made, from nothing
/// while the obstacle is far ahead to more than is needed when it is near.
Setpoint Avoidance::steer(const ObstacleView& view, const Observation& observation, const Setpoint& setpoint,
                          const FieldOfView& field_of_view, double heading_rad, double dt_s,
                          AvoidanceOutput& output) noexcept {
  const double theta = observation.bearing_rad, look_m = config_.look_ahead_m, most_rad = config_.max_shift_rad;
  const double radius_m = config_.robot_radius_m + config_.margin_m + config_.passing_m;
  const ObstacleView around = within(view, look_m + radius_m);
  const double right_rad = field_of_view.right_rad + kEdge_rad, left_rad = field_of_view.left_rad - kEdge_rad;
  const double least = std::max(theta - left_rad, -kSidewards_rad),
               greatest = std::min(theta - right_rad, kSidewards_rad);
  const double wanted_rad = wrap_angle(theta - setpoint.bearing_rad);
  const auto way = [&](double direction_rad) {
    return std::min(free_way_towards_m(around, direction_rad, radius_m), look_m);
  };
  const auto cost = [&](double direction_rad) {
    double sum = 1.0 - way(direction_rad) / look_m + kTurnCost * std::abs(direction_rad - wanted_rad) / most_rad +
                 kNearCost * approach(around, direction_rad, radius_m) +
                 kSightCost * sight_blocked(around, config_, observation, direction_rad);
    if (chosen_heading_rad_)
      sum += kSwitchCost * std::abs(wrap_angle(heading_rad + direction_rad - *chosen_heading_rad_)) / most_rad;
    return sum;
  };

  output.free_way_m = way(wanted_rad);
  const double blocked =
      std::max(1.0 - output.free_way_m / look_m, 0.7 * sight_blocked(around, config_, observation, wanted_rad));
  double best_rad = wanted_rad, target_rad = 0.0;
  if (blocked > 0.0) {
    double best = cost(wanted_rad);
    const int steps = static_cast<int>(std::ceil(2.0 * kSidewards_rad / kFan_rad));
    for (int i = 2; i < 2 * steps; ++i) {  // to both sides of the wanted one
      const int away = i / 2;
      const double direction_rad = wanted_rad + (i % 2 == 0 ? away : -away) * kFan_rad;
      if (direction_rad < least || direction_rad > greatest) continue;
      const double here = cost(direction_rad);
      if (here >= best) continue;
      best = here;
      best_rad = direction_rad;
    }
    target_rad = most_rad * fuzzy::infer_output(rules_, (best_rad - wanted_rad) / most_rad, 2.0 * blocked - 1.0);
    if (!std::isfinite(target_rad)) target_rad = 0.0;
    chosen_heading_rad_ = heading_rad + best_rad;
  } else {
    chosen_heading_rad_.reset();
  }
  output.free_direction_rad = best_rad;

  const bool grows = std::abs(target_rad) > std::abs(shift_rad_) || target_rad * shift_rad_ < 0.0;
  const double time_s = grows ? config_.shift_time_s : config_.return_time_s;
  shift_rad_ += (target_rad - shift_rad_) * (time_s > dt_s ? dt_s / time_s : 1.0);
  Setpoint shifted = setpoint;
  // Not out of the picture; but a bearing that was asked for there is nobody's fault here.
  const double lowest = std::max(std::min(right_rad, setpoint.bearing_rad), -kMaxBearing_rad);
  const double highest = std::min(std::max(left_rad, setpoint.bearing_rad), kMaxBearing_rad);
  if (shift_rad_ != 0.0) shifted.bearing_rad = std::clamp(setpoint.bearing_rad - shift_rad_, lowest, highest);
  output.bearing_shift_rad = setpoint.bearing_rad - shifted.bearing_rad;
  return shifted;
}

/// From a way s it can stop with a gentle b if v^2 = 2 b s: with kGentle of the drive's acceleration, so that there is
/// time to turn before the last rule, which knows no passing_m, would stop it.
Twist Avoidance::moderate(const ObstacleView& view, const Twist& wanted, const Twist& own, double acceleration_mps2,
                          double dt_s, AvoidanceOutput& output) noexcept {
  if (backing_m_ > 0.0 && backing_s_ > 0.0) {
    backing_m_ -= std::max(-own.linear_mps, 0.0) * dt_s;
    backing_s_ -= dt_s;
    output.backing_off = true;
    return {-config_.back_off_mps, wanted.angular_radps};
  }
  if (wanted.linear_mps <= 0.0) return wanted;
  const double radius_m = config_.robot_radius_m + config_.margin_m + config_.passing_m;
  const double curvature = wanted.angular_radps / std::max(wanted.linear_mps, config_.creep_mps);
  const double way_m = std::min(free_way_m(view, 0.0, radius_m), free_way_m(view, 0.5 * curvature, radius_m));
  const double gentle_mps = std::sqrt(2.0 * kGentle * acceleration_mps2 * std::min(way_m, 1e3));
  return {std::min(wanted.linear_mps, std::max(gentle_mps, config_.creep_mps)), wanted.angular_radps};
}

void Avoidance::allowed(double allowed_mps, double wanted_mps, double dt_s) noexcept {
  const bool blocked = wanted_mps > 0.0 && allowed_mps < kStands_mps;
  blocked_s_ = blocked ? blocked_s_ + dt_s : 0.0;
  if (!blocked || blocked_s_ < config_.blocked_s || !(config_.back_off_m > 0.0)) return;
  blocked_s_ = 0.0;
  backing_m_ = config_.back_off_m;
  backing_s_ = 2.0 * config_.back_off_m / config_.back_off_mps;
}

void Avoidance::restart() noexcept {
  blocked_s_ = backing_m_ = backing_s_ = 0.0;
  shift_rad_ = 0.0;
  chosen_heading_rad_.reset();
}

}  // namespace pilotfish::control
