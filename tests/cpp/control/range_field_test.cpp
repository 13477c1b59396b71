#include "pilotfish/control/range_field.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "memory_asked_for.hpp"
#include "pilotfish/core/angles.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

constexpr RangeReadingModel kSonar{radians(15.0), 3.0, 0.15};

RangeScan ring(std::int64_t utime, float range_m) {
  RangeScan scan;
  scan.utime = utime;
  scan.first_rad = radians(-172.5);
  scan.step_rad = radians(15.0);
  for (int i = 0; i < 24; ++i) scan.ranges_m.push_back(range_m);
  return scan;
}

double nearest_m(const ObstacleView& view) {
  double least = INFINITY;
  for (const SurfacePoint& point : view.points) least = std::min(least, std::hypot(point.x_m, point.y_m));
  return least;
}

TEST(RangeField, ARingCoversEveryDirectionAndALaserOnlyWhereItLooks) {
  RangeField field;
  field.add(ring(1000, 2.0F), {}, 1000);
  EXPECT_TRUE(field.view(kSonar, 1000).covered.all());

  RangeField laser;
  RangeScan scan;
  scan.utime = 1000;
  scan.first_rad = radians(-90.0);
  scan.step_rad = radians(1.0);
  for (int i = 0; i <= 180; ++i) scan.ranges_m.push_back(5.0F);
  laser.add(scan, {}, 1000);
  const ObstacleView view = laser.view({0.0, 10.0, 0.15}, 1000);
  EXPECT_TRUE(view.covers(0.0, radians(60.0)));
  EXPECT_FALSE(view.covers(kPi, radians(60.0)));
  EXPECT_FALSE(view.covers(radians(80.0), radians(60.0)));
}

TEST(RangeField, RaysFartherApartThanASectorLeaveWhatIsBetweenThemUnknown) {
  // Sectors are 2 degrees wide. A sonar looks all across its cone; a ray looks along a line.
  for (const double degrees : {0.5, 1.0, 2.0, 2.5, 3.0, 4.0, 5.0}) {
    for (const double from : {-180.0, -179.0, -178.3}) {
      RangeField field;
      RangeScan scan;
      scan.utime = 1000;
      scan.first_rad = radians(from);
      scan.step_rad = radians(degrees);
      for (int i = 0; i < static_cast<int>(360.0 / degrees); ++i) scan.ranges_m.push_back(5.0F);
      field.add(scan, {}, 1000);
      EXPECT_EQ(field.view({0.0, 10.0, 0.15}, 1000).covers(0.0, radians(60.0)), degrees <= 2.0) << degrees << from;
      EXPECT_TRUE(field.view({radians(10.0), 10.0, 0.15}, 1000).covers(0.0, radians(60.0)));
    }
  }
}

TEST(RangeField, AReadingOfNothingIsASurfaceThatTouchesTheRobotHoweverItHasMovedSince) {
  for (const float range_m : {0.0F, 1e-9F, 0.001F, 0.02F}) {
    RangeField field;
    field.add(ring(1000, range_m), {}, 1000);
    field.moved({}, {0.06, 0.0, 0.1});  // 0.1 s at 0.6 m/s
    const ObstacleView view = field.view(kSonar, 1000);
    EXPECT_TRUE(view.covered.all());
    EXPECT_NEAR(nearest_m(view), 0.05, 1e-6);
    int ahead = 0;
    for (const SurfacePoint& point : view.points) ahead += point.x_m > 0.03 ? 1 : 0;
    EXPECT_GT(ahead, 30) << range_m;
  }
}

TEST(RangeField, AnObstacleStaysWhereItIsWhileTheRobotMoves) {
  RangeField field;
  RangeScan scan = ring(1000, 3.0F);
  scan.ranges_m[12] = 1.0F;  // around 7.5 degrees
  field.add(scan, {}, 1000);
  // 0.3 m ahead and a quarter turn to the left: what was at (1, 0) is at (0, -0.7) now.
  field.moved({5.0, 1.0, 0.0}, {5.3, 1.0, kPi / 2.0});
  const ObstacleView view = field.view(kSonar, 1000);
  bool found = false;
  for (const SurfacePoint& point : view.points) found = found || std::hypot(point.x_m - 0.0, point.y_m + 0.7) < 0.02;
  EXPECT_TRUE(found);
}

TEST(RangeField, ReadingsThatAreTooOldSayNothing) {
  RangeField field;
  field.add(ring(1'000'000, 1.0F), {}, 1'000'000);
  EXPECT_TRUE(field.fresh_at(1'150'000, 0.15));
  EXPECT_FALSE(field.fresh_at(1'150'001, 0.15));
  EXPECT_TRUE(field.view(kSonar, 1'150'001).covered.none());
}

TEST(RangeField, ASensorWithoutAReadingKeepsTheOneBeforeWhileThatIsFresh) {
  RangeField field;
  RangeScan scan = ring(1'000'000, 3.0F);
  scan.ranges_m[5] = 0.8F;
  field.add(scan, {}, 1'000'000);
  scan.utime = 1'100'000;
  scan.ranges_m[5] = -1.0F;
  field.add(scan, {}, 1'100'000);
  EXPECT_NEAR(nearest_m(field.view(kSonar, 1'140'000)), 0.8, 1e-6);
  const ObstacleView later = field.view(kSonar, 1'160'000);
  EXPECT_TRUE(later.points.empty());
  EXPECT_FALSE(later.covered.all());
}

TEST(RangeField, MeasuresWithoutAskingForMemory) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  RangeField field;
  const RangeScan scan = ring(1000, 1.0F);
  std::size_t points = 0;
  const auto asked = tests::memory_asked_for([&] {
    field.add(scan, {0.3, 0.2}, 1000);
    field.moved({}, {0.1, 0.0, 0.1});
    points = field.view(kSonar, 1000).points.size();
  });
  EXPECT_EQ(asked, 0);
  EXPECT_GT(points, 0U);
}

}  // namespace
