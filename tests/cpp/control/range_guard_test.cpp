#include "pilotfish/control/range_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pilotfish/core/angles.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

AvoidanceConfig config() {
  AvoidanceConfig config;
  config.enabled = true;
  return config;
}

const Reaction kReaction{LimitsConfig{}, 0.1, 0.1};

ObstacleView open_ground() {
  ObstacleView view;
  view.covered.set();
  return view;
}

ObstacleView with_point(double x_m, double y_m) {
  ObstacleView view = open_ground();
  view.points.push_back({x_m, y_m});
  return view;
}

double guarded(const ObstacleView& view, const Twist& wanted, const Twist& own = {}) {
  return guarded_by_ranges(config(), kReaction, view, wanted, own, 0.0);
}

TEST(RangeGuard, LeavesARobotOnOpenGroundAlone) {
  for (const double v : {-0.3, 0.0, 0.2, 0.6}) EXPECT_EQ(guarded(open_ground(), {v, 0.7}), v);
}

TEST(RangeGuard, AllowsTheSpeedThatStopsJustBefore) {
  // Radius and margin are 0.30 m, the point is 0.8 m ahead: a way of 0.5 m. From rest tau v_0 is 0, so v H + v^2 / 2a
  // fits for v = sqrt(0.1^2 + 2 * 0.5) - 0.1 = 0.905 with H = 0.1 s and a = 1 m/s^2.
  const double v = std::sqrt(0.01 + 1.0) - 0.1;
  EXPECT_NEAR(guarded(with_point(0.8, 0.0), {2.0, 0.0}), v, 1e-12);
  // At 0.4 m/s the lag of 0.1 s takes 0.04 m.
  EXPECT_NEAR(guarded(with_point(0.8, 0.0), {2.0, 0.0}, {0.4, 0.0}), std::sqrt(0.01 + 2.0 * 0.46) - 0.1, 1e-12);
  EXPECT_NEAR(guarded(with_point(-0.8, 0.0), {-2.0, 0.0}), -v, 1e-12);  // backwards likewise
  EXPECT_EQ(guarded(with_point(-0.8, 0.0), {0.6, 0.0}), 0.6);           // what is behind is not in the way
}

TEST(RangeGuard, StandsWhereEveryReadingIsZero) {
  RangeField field;
  RangeScan scan;
  scan.utime = 1000;
  scan.first_rad = -kPi;
  scan.step_rad = radians(1.0);
  for (int i = 0; i < 360; ++i) scan.ranges_m.push_back(0.0F);
  field.add(scan, {}, 1000);
  field.moved({}, {0.03, 0.0, 0.0});
  const ObstacleView view = field.view({0.0, 10.0, 0.15}, 51'000);
  EXPECT_EQ(guarded(view, {0.6, 0.3}, {0.58, 0.0}), 0.0);
  EXPECT_EQ(guarded(view, {-0.3, 0.0}), 0.0);
}

TEST(RangeGuard, StandsWhereNothingIsKnownOfThePath) {
  EXPECT_EQ(guarded(ObstacleView{}, {0.3, 0.0}), 0.0);
  ObstacleView ahead = open_ground();
  ahead.covered.reset(0);  // straight behind
  EXPECT_EQ(guarded(ahead, {0.3, 0.0}), 0.3);
  EXPECT_EQ(guarded(ahead, {-0.3, 0.0}), 0.0);
}

/// Drives as the command says for the hold, then ramps down behind the lag, and returns the least distance to the
/// point.
double least_distance_m(const Twist& command, Twist own, const SurfacePoint& point) {
  constexpr double kStep_s = 2e-3;
  const LimitsConfig& limits = kReaction.limits;
  Pose2 pose;
  double v_set = own.linear_mps, w_set = own.angular_radps, v = own.linear_mps, w = own.angular_radps;
  double least_m = INFINITY;
  for (double t = 0.0; t < 1.5; t += kStep_s) {
    const Twist target = t < kReaction.hold_s ? command : Twist{};
    follow_set_value(v, v_set, target.linear_mps, limits.max_linear_acceleration_mps2, kReaction.actuator_lag_s,
                     kStep_s);
    follow_set_value(w, w_set, target.angular_radps, limits.max_angular_acceleration_radps2, kReaction.actuator_lag_s,
                     kStep_s);
    pose = move_along_arc(pose, {v, w}, kStep_s);
    least_m = std::min(least_m, std::hypot(point.x_m - pose.x_m, point.y_m - pose.y_m));
  }
  return least_m;
}

TEST(RangeGuard, ARobotThatBrakesAtOnceNeverTouchesWhateverItWasDoing) {
  // The oracle is a drive that is integrated step by step. The set value is assumed where the wheels are: a robot that
  // was just allowed its speed, and whose turn rate may be any.
  std::mt19937 random(2);
  const auto drawn = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  const double radius_m = config().robot_radius_m;
  int limited = 0;
  for (int i = 0; i < 1500; ++i) {
    const double range_m = drawn(0.31, 0.8), direction_rad = drawn(-kPi / 2.0, kPi / 2.0);
    const SurfacePoint point{range_m * std::cos(direction_rad), range_m * std::sin(direction_rad)};
    const ObstacleView view = with_point(point.x_m, point.y_m);
    Twist own{drawn(0.0, 0.6), drawn(-1.5, 1.5)};
    own.linear_mps = guarded(view, own, own);  // a state that was allowed
    const Twist wanted{drawn(0.0, 0.6), drawn(-1.5, 1.5)};
    const Twist command{guarded(view, wanted, own), wanted.angular_radps};
    limited += command.linear_mps < wanted.linear_mps ? 1 : 0;
    EXPECT_GT(least_distance_m(command, own, point), radius_m)
        << "point " << point.x_m << " " << point.y_m << " own " << own.linear_mps << " " << own.angular_radps
        << " command " << command.linear_mps << " " << command.angular_radps << " wanted " << wanted.linear_mps;
  }
  EXPECT_GT(limited, 100);
}

}  // namespace
