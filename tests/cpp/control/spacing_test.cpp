#include "pilotfish/control/spacing.hpp"

#include <gtest/gtest.h>

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
  EXPECT_EQ(with_headway(config, asked, -0.3).distance_m, 1.0);  // backwards: never nearer than d_p
  EXPECT_EQ(with_headway({}, asked, 0.4).distance_m, 1.0);
}

}  // namespace
