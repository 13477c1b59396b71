#include "pilotfish/sim/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::sim {
namespace {

/// After a time t of braking (or speeding up) with a from speed v.
Progress with_constant_acceleration(double v, double a, double t) { return {v * t + a * t * t / 2.0, v + a * t}; }

/// A move of a given length from rest to rest: up with a, along at `speed` if there is room, down with a.
struct Move {
  Move(double length, double speed, double acceleration)
      : length_(length), acceleration_(acceleration), peak_(std::min(speed, std::sqrt(length * acceleration))) {}

  double duration_s() const { return length_ > 0.0 ? length_ / peak_ + peak_ / acceleration_ : 0.0; }
  Progress at(double t) const {
    const double ramp = peak_ / acceleration_;
    if (t < ramp) return with_constant_acceleration(0.0, acceleration_, t);
    if (t < duration_s() - ramp) return {peak_ * (t - ramp / 2.0), peak_};
    const Progress left = with_constant_acceleration(0.0, acceleration_, std::max(0.0, duration_s() - t));
    return {length_ - left.distance_m, left.speed_mps};  // the same, seen from the end
  }

 private:
  double length_, acceleration_, peak_;
};

/// The pose `local` (given in the frame of `start`) in the world.
Pose2 in_world(const Pose2& start, const Pose2& local) {
  const double c = std::cos(start.heading_rad), s = std::sin(start.heading_rad);
  return {start.x_m + c * local.x_m - s * local.y_m, start.y_m + s * local.x_m + c * local.y_m,
          wrap_angle(start.heading_rad + local.heading_rad)};
}

/// Speed of the lemniscate's parameter: |d(x, y)/dp| with x = a sin p, y = b sin p cos p.
double lemniscate_rate(const FigureEight& eight, double p) {
  return std::hypot(eight.half_length_m * std::cos(p), eight.half_width_m * std::cos(2.0 * p));
}

/// Its integral from 0 to p: Gauss-Legendre with 5 nodes on pieces of at most pi/16, exact to 1e-12 of the length.
double lemniscate_length(const FigureEight& eight, double p) {
  constexpr double nodes[] = {0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr double weights[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const int pieces = 1 + static_cast<int>(std::abs(p) / (kPi / 16.0));
  const double half = p / pieces / 2.0;
  double sum = 0.0;
  for (int i = 0; i < pieces; ++i) {
    const double middle = (2 * i + 1) * half;
    sum += weights[0] * lemniscate_rate(eight, middle);
    for (int k = 1; k < 3; ++k)
      sum += weights[k] *
             (lemniscate_rate(eight, middle - nodes[k] * half) + lemniscate_rate(eight, middle + nodes[k] * half));
  }
  return sum * half;
}

UnicycleState state_of(const Still&, const Pose2& start, double) { return {start, {}}; }

UnicycleState state_of(const Line& line, const Pose2& start, double time_s) {
  const Progress progress = progress_at(line.profile, time_s);
  return {move_along_arc(start, {progress.distance_m, 0.0}, 1.0), {progress.speed_mps, 0.0}};
}

UnicycleState state_of(const Circle& circle, const Pose2& start, double time_s) {
  const Progress progress = progress_at(circle.profile, time_s);
  const double curvature = (circle.clockwise ? -1.0 : 1.0) / circle.radius_m;
  return {move_along_arc(start, {progress.distance_m, progress.distance_m * curvature}, 1.0),
          {progress.speed_mps, progress.speed_mps * curvature}};
}

UnicycleState state_of(const FigureEight& eight, const Pose2& start, double time_s) {
  const Progress progress = progress_at(eight.profile, time_s);
  const double a = eight.half_length_m, b = eight.half_width_m, lap = lap_length_m(eight);
  const double along = progress.distance_m - lap * std::floor(progress.distance_m / lap);
  // Newton for length(p) = along; the rate is bounded away from zero, and the start is good.
  double p = 2.0 * kPi * along / lap;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const double step = (lemniscate_length(eight, p) - along) / lemniscate_rate(eight, p);
    p -= step;
    if (std::abs(step) < 1e-13) break;
  }
  // Turned by the direction at p = 0, so that it leaves the start straight ahead.
  const double leaving = std::atan2(b, a);
  const double rate = lemniscate_rate(eight, p);
  const double curvature =
      a * b * (std::cos(2.0 * p) * std::sin(p) - 2.0 * std::sin(2.0 * p) * std::cos(p)) / (rate * rate * rate);
  const Pose2 turned = in_world({0.0, 0.0, -leaving}, {a * std::sin(p), b * std::sin(p) * std::cos(p),
                                                       std::atan2(b * std::cos(2.0 * p), a * std::cos(p))});
  return {in_world(start, turned), {progress.speed_mps, progress.speed_mps * curvature}};
}

UnicycleState state_of(const Waypoints& waypoints, const Pose2& start, double time_s) {
  Pose2 here;  // in the frame of the start
  double left_s = time_s - waypoints.start_time_s;
  if (left_s <= 0.0) return {start, {}};
  do {
    double lap_s = 0.0;
    for (const Waypoint& goal : waypoints.points) {
      const double dx = goal.x_m - here.x_m, dy = goal.y_m - here.y_m, length = std::hypot(dx, dy);
      const double direction = length > 0.0 ? std::atan2(dy, dx) : here.heading_rad;
      const double angle = wrap_angle(direction - here.heading_rad);
      const Move turn(std::abs(angle), waypoints.turn_rate_radps, waypoints.turn_acceleration_radps2);
      const Move drive(length, waypoints.speed_mps, waypoints.acceleration_mps2);
      if (left_s < turn.duration_s()) {
        const Progress progress = turn.at(left_s);
        here.heading_rad += std::copysign(progress.distance_m, angle);
        return {in_world(start, here), {0.0, std::copysign(progress.speed_mps, angle)}};
      }
      left_s -= turn.duration_s();
      here.heading_rad = direction;
      if (left_s < drive.duration_s()) {
        const Progress progress = drive.at(left_s);
        const Pose2 local = move_along_arc(here, {progress.distance_m, 0.0}, 1.0);
        return {in_world(start, local), {progress.speed_mps, 0.0}};
      }
      left_s -= drive.duration_s() + goal.pause_s;
      here.x_m = goal.x_m;
      here.y_m = goal.y_m;
      if (left_s < 0.0) return {in_world(start, here), {}};
      lap_s += turn.duration_s() + drive.duration_s() + goal.pause_s;
    }
    if (!(lap_s > 0.0)) break;  // nowhere to go
  } while (waypoints.repeat);
  return {in_world(start, here), {}};
}

}  // namespace

Progress progress_at(const SpeedProfile& profile, double time_s) {
  const double sign = profile.speed_mps < 0.0 ? -1.0 : 1.0, top = std::abs(profile.speed_mps);
  const double a = profile.acceleration_mps2;
  const double driving_s = std::min(time_s, profile.stop_time_s) - profile.start_time_s;
  if (driving_s <= 0.0) return {};
  const double rise_s = std::min(driving_s, top / a);
  const Progress risen = with_constant_acceleration(0.0, a, rise_s);
  Progress progress{risen.distance_m + risen.speed_mps * (driving_s - rise_s), risen.speed_mps};
  if (time_s > profile.stop_time_s) {
    const double braking_s = time_s - profile.stop_time_s, rest_after_s = progress.speed_mps / a;
    const bool at_rest = braking_s >= rest_after_s;
    const Progress braked = with_constant_acceleration(progress.speed_mps, -a, at_rest ? rest_after_s : braking_s);
    progress = {progress.distance_m + braked.distance_m, at_rest ? 0.0 : braked.speed_mps};
  }
  return {sign * progress.distance_m, sign * progress.speed_mps};
}

double lap_length_m(const FigureEight& eight) { return lemniscate_length(eight, 2.0 * kPi); }

UnicycleState state_at(const Trajectory& trajectory, const Pose2& start, double time_s) {
  return std::visit([&](const auto& kind) { return state_of(kind, start, std::max(0.0, time_s)); }, trajectory);
}

}  // namespace pilotfish::sim
