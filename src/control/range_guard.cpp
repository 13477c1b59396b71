#include "pilotfish/control/range_guard.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/control/free_way.hpp"
#include "pilotfish/core/angles.hpp"

namespace pilotfish::control {
namespace {

constexpr double kHalfPath_rad = radians(60.0);  // nearer to the side a surface is beside the path already
constexpr double kTightest = 20.0;               // [1/m]; on a circle of 5 cm a robot turns in place
constexpr double kRolling_mps = 0.05;            // below, the present curvature says nothing
constexpr int kCurvatures = 7, kRounds = 12;

/// Driving backwards is driving ahead in a mirror: x changes its sign, and so do speed and turn rate, whose quotient,
/// the path's curvature, stays.
ObstacleView mirrored(const ObstacleView& view) noexcept {
  ObstacleView other;
  for (const SurfacePoint& point : view.points) other.points.push_back({-point.x_m, point.y_m});
  return other;
}

double curvature_of(const Twist& twist) noexcept {
  return std::clamp(twist.angular_radps / twist.linear_mps, -kTightest, kTightest);
}

}  // namespace

/// The command v acts for the hold H, then the set value falls with a; a first-order lag tau adds tau v_0 to the way,
/// with v_0 the real speed when the command acts, and a surface that comes nearer with c shortens it. As in
/// collision_guard.cpp
///
///   (v + c) H + (v + c)^2 / 2a + tau (v_0 + c)  must fit into  room = way - c age,   so
///   v = -c - a H + sqrt((a H)^2 + 2 a (room - tau (v_0 + c))).
///
/// Which way? While the robot slows down its turn rate may still be the present one, that of the command, or none: its
/// curvature is somewhere between the present one, w / v and 0. Of all these circles some are tried, and the shortest
/// way counts. A lower speed makes the same turn rate a tighter circle: so the bound is found by going down until it
/// holds for itself. It ends at 0, where the robot turns in place, which for a circle needs no room.
///
/// As there: once it holds it holds for ever, because the next command may be v - a P on the same circle, and that
/// fits again.
double guarded_by_ranges(const AvoidanceConfig& config, const Reaction& reaction, const ObstacleView& view,
                         const Twist& wanted, const Twist& own, double age_s) noexcept {
  if (wanted.linear_mps == 0.0) return 0.0;
  const bool ahead = wanted.linear_mps > 0.0;
  if (!view.covers(ahead ? 0.0 : kPi, kHalfPath_rad)) return 0.0;
  ObstacleView other;
  if (!ahead) other = mirrored(view);
  const ObstacleView& seen = ahead ? view : other;

  const double radius_m = config.robot_radius_m + config.margin_m;
  const double a = reaction.limits.max_linear_acceleration_mps2, held = a * reaction.hold_s;
  const double c = config.obstacle_speed_mps, own_mps = ahead ? own.linear_mps : -own.linear_mps;
  const double lost_m = c * age_s + reaction.actuator_lag_s * (std::max(own_mps, 0.0) + c);
  const auto bound = [&](double way_m) {
    const double room_m = way_m - lost_m;
    return room_m > 0.0 ? std::max(std::sqrt(held * held + 2.0 * a * room_m) - held - c, 0.0) : 0.0;
  };
  const double now = own_mps > kRolling_mps ? curvature_of(own) : 0.0;
  double speed_mps = std::abs(wanted.linear_mps);
  for (int round = 0; round < kRounds && speed_mps > 0.0; ++round) {
    const double then = curvature_of({ahead ? speed_mps : -speed_mps, wanted.angular_radps});
    const auto [least, most] = std::minmax({0.0, now, then});
    double allowed_mps = speed_mps;
    for (int i = 0; i < kCurvatures; ++i) {
      const double curvature = least + (most - least) * i / (kCurvatures - 1);
      allowed_mps = std::min(allowed_mps, bound(free_way_m(seen, curvature, radius_m)));
    }
    if (allowed_mps >= speed_mps) return ahead ? speed_mps : -speed_mps;
    speed_mps = allowed_mps;
  }
  return 0.0;
}

}  // namespace pilotfish::control
