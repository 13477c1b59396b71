#include "pilotfish/control/collision_guard.hpp"

#include <gtest/gtest.h>

#include "pilotfish/core/angles.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

Gap gap(double distance_m, double leaving_mps = 0.0, double bearing_rad = 0.0) {
  return {distance_m, bearing_rad, 0.0, 0.0, 0.0, leaving_mps};
}

Reaction reaction() { return {LimitsConfig{}, 0.1, 0.1}; }

TEST(CollisionGuard, GivesBackWhatIsMissingToTheShortestDistanceWithinHalfASecond) {
  // d_min is 0.45 m. At 0.35 m a tenth is missing: 0.1 / 0.5 = 0.2 m/s back, and as much more as the leader comes;
  // while it comes with 0.1 m/s the wheels' lag of 0.1 s takes another 0.01 m.
  EXPECT_NEAR(guarded_speed({}, reaction(), gap(0.35)), -0.2, 1e-12);
  EXPECT_NEAR(guarded_speed({}, reaction(), gap(0.35, -0.1)), -0.22 - 0.1, 1e-12);
  EXPECT_NEAR(guarded_speed({}, reaction(), gap(0.35, 0.1)), -0.2, 1e-12);  // it leaves: that may end at any time
  // A distance known to 10 mm counts as three of them less.
  Gap unsure = gap(0.35);
  unsure.distance_sigma_m = 0.01;
  EXPECT_NEAR(guarded_speed({}, reaction(), unsure), -0.26, 1e-12);
}

TEST(CollisionGuard, CountsTheBrakingOfALeaderThatCannotStopDead) {
  // From 0.4 m/s at 2 m/s^2 it covers another 0.16 / 4 = 0.04 m.
  GuardConfig config;
  config.leader_deceleration_mps2 = 2.0;
  EXPECT_NEAR(guarded_speed(config, reaction(), gap(1.0, 0.4)), guarded_speed({}, reaction(), gap(1.04)), 1e-12);
  EXPECT_NEAR(guarded_speed(config, reaction(), gap(1.0, -0.4)), guarded_speed({}, reaction(), gap(1.0, -0.4)), 1e-12);
}

TEST(CollisionGuard, AllowsForwardAtAnyBearingWhatItAllowsStraightAhead) {
  // The robot may turn to the leader while it brakes.
  const double straight = guarded_speed({}, reaction(), gap(1.1));
  EXPECT_GT(straight, 0.0);
  for (const double bearing_rad : {0.0, 0.5, -1.0, 1.5, 3.0})
    EXPECT_EQ(guarded_forward_speed({}, reaction(), gap(1.1, 0.0, bearing_rad)), straight);
}

TEST(CollisionGuard, RecedesFasterFromALeaderAtABearing) {
  // Of a speed v cos(bearing) is in the line of sight: at 60 degrees half of it. Beside the robot, where none is, it
  // counts as if three tenths were; behind it, too.
  const double straight = guarded_speed({}, reaction(), gap(0.3));
  EXPECT_LT(straight, 0.0);
  for (const double side : {-1.0, 1.0}) {
    const auto forward = [&](double bearing_rad) {
      return guarded_forward_speed({}, reaction(), gap(0.3, 0.0, side * bearing_rad));
    };
    EXPECT_NEAR(forward(0.0), straight, 1e-12);
    EXPECT_NEAR(forward(radians(60.0)), straight / 0.5, 1e-12);
    EXPECT_NEAR(forward(radians(90.0)), straight / 0.3, 1e-12);
    EXPECT_NEAR(forward(radians(150.0)), straight / 0.3, 1e-12);
  }
}

}  // namespace
