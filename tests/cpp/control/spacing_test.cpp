#include "pilotfish/control/spacing.hpp"

#include <gtest/gtest.h>

#include "pilotfish/control/fuzzy_velocity_law.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

TEST(Spacing, AddsTheWayOfTheHeadwayToTheDistanceAndNothingElse) {
  SpacingConfig config;
  config.headway_s = 0.5;
  const Setpoint asked{1.0, 0.1, true};
  const Setpoint wanted = with_headway(config, asked, 0.4);
  EXPECT_DOUBLE_EQ(wanted.distance_m, 1.0 + 0.5 * 0.4);
  EXPECT_EQ(wanted.bearing_rad, asked.bearing_rad);
  EXPECT_TRUE(wanted.run);
  EXPECT_EQ(with_headway(config, asked, -0.3).distance_m, 1.0);  // it comes: never nearer than d_p
  EXPECT_EQ(with_headway({}, asked, 0.4).distance_m, 1.0);
}

TEST(Spacing, MakesTheLawLessSteepByOnePlusHeadwayTimesSlope) {
  SpacingConfig config;
  config.headway_s = 0.5;
  FuzzyVelocityConfig scales;
  scales.velocity_scale_mps = 0.6;
  scales.error_scale_m = 0.3;  // slope 2 per second: 1 + 0.5 x 2 = 2
  scales.error_change_scale_m = 0.02;
  const FuzzyVelocityConfig flatter = with_headway(config, scales);
  EXPECT_DOUBLE_EQ(flatter.error_scale_m, 0.6);
  EXPECT_DOUBLE_EQ(flatter.error_change_scale_m, 0.04);
  EXPECT_EQ(flatter.velocity_scale_mps, 0.6);
  EXPECT_EQ(with_headway({}, scales).error_scale_m, 0.3);
}

}  // namespace
