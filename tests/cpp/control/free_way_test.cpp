#include "pilotfish/control/free_way.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pilotfish/core/angles.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

TEST(FreeWay, StraightAheadEndsWhereTheDiscTouches) {
  // A point at (1, 0.15) and a disc of 0.25: 0.25^2 - 0.15^2 = 0.2^2, so it touches at 1 - 0.2.
  EXPECT_NEAR(free_way_m(SurfacePoint{1.0, 0.15}, 0.0, 0.25), 0.8, 1e-12);
  EXPECT_EQ(free_way_m(SurfacePoint{1.0, 0.25}, 0.0, 0.25), INFINITY);
  EXPECT_EQ(free_way_m(SurfacePoint{-1.0, 0.0}, 0.0, 0.25), INFINITY);
}

TEST(FreeWay, OfAPointWithinTheDiscIsNoneTowardsItAndNeverEndsAwayFromIt) {
  EXPECT_EQ(free_way_m(SurfacePoint{0.1, 0.1}, 0.0, 0.25), 0.0);
  EXPECT_EQ(free_way_m(SurfacePoint{-0.1, 0.1}, 0.0, 0.25), INFINITY);
}

TEST(FreeWay, OnACircleIsTheFirstArcAtWhichTheDiscTouches) {
  // The oracle walks along the circle in steps of 0.1 mm and looks for the first one within the radius.
  std::mt19937 random(1);
  const auto drawn = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  int touched = 0;
  for (int i = 0; i < 100; ++i) {
    const double curvature = drawn(-4.0, 4.0), radius_m = drawn(0.05, 0.3);
    const double range_m = drawn(radius_m + 0.02, 1.0), direction_rad = drawn(-kPi / 2.0, kPi / 2.0);
    const SurfacePoint point{range_m * std::cos(direction_rad), range_m * std::sin(direction_rad)};
    const double end_m = 1.9 * kPi / std::abs(curvature);  // before the second turn
    double expected_m = INFINITY;
    for (double s = 0.0; s < std::min(end_m, 3.0) && std::isinf(expected_m); s += 1e-4) {
      const double x = std::sin(curvature * s) / curvature, y = (1.0 - std::cos(curvature * s)) / curvature;
      if (std::hypot(point.x_m - x, point.y_m - y) <= radius_m) expected_m = s;
    }
    const double way_m = free_way_m(point, curvature, radius_m);
    if (std::isinf(expected_m)) {
      EXPECT_GT(way_m, std::min(end_m, 3.0) - 1e-3);
    } else {
      EXPECT_NEAR(way_m, expected_m, 2e-4);
      ++touched;
    }
  }
  EXPECT_GT(touched, 15);
}

TEST(FreeWay, TowardsADirectionIsTheWayStraightAheadOfARobotThatHasTurnedThere) {
  ObstacleView view;
  view.points.push_back({0.5, 0.5});
  // At 45 degrees, sqrt(1/2) away.
  EXPECT_NEAR(free_way_towards_m(view, radians(45.0), 0.2), std::sqrt(0.5) - 0.2, 1e-12);
  EXPECT_EQ(free_way_towards_m(view, radians(-45.0), 0.2), INFINITY);
}

}  // namespace
