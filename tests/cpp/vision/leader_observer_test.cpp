#include "pilotfish/vision/leader_observer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <type_traits>

#include "pilotfish/core/checkpoint.hpp"
#include "tag_picture.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::vision;

static_assert(std::is_nothrow_move_constructible_v<LeaderObserver>);
static_assert(!std::is_copy_constructible_v<LeaderObserver>);
static_assert(noexcept(std::declval<LeaderObserver&>().observe(std::declval<const Frame&>())));
static_assert(noexcept(std::declval<LeaderObserver&>().forget()));

/// 64 pixels of a tag of 0.16 m at fx = 400: it is 400 * 0.16 / 64 = 1 m away, and right ahead.
CameraModel camera() { return {200, 200, 400.0, 400.0, 99.5, 99.5}; }

LeaderBody body() {
  LeaderBody body;
  BodyTag tag;
  tag.id = 7;
  body.tags.push_back(tag);
  return body;
}

TEST(LeaderObserver, MeasuresAMetreWhereItMustBeOne) {
  LeaderObserver observer(camera(), {}, body(), {});
  const ObservationResult sight = observer.observe(tests::tag_frame(7));
  ASSERT_TRUE(sight.observation.has_value()) << to_string(sight.reason);
  EXPECT_NEAR(sight.observation->distance_m, 1.0, 0.01);
  EXPECT_NEAR(sight.observation->bearing_rad, 0.0, 0.002);
}

TEST(LeaderObserver, StillTracksAfterAMove) {
  LeaderObserver observer(camera(), {}, body(), {});
  ASSERT_TRUE(observer.observe(tests::tag_frame(7, 0)).observation.has_value());
  LeaderObserver moved = std::move(observer);
  const ObservationResult sight = moved.observe(tests::tag_frame(7, 33'333));
  ASSERT_TRUE(sight.observation.has_value()) << to_string(sight.reason);
  EXPECT_EQ(sight.observation->found_by, FoundBy::track);  // it knows where the leader was
  EXPECT_EQ(moved.whole_picture_searches(), 1);
}

TEST(LeaderObserver, SearchesAgainAfterItHasForgotten) {
  LeaderObserver observer(camera(), {}, body(), {});
  observer.observe(tests::tag_frame(7, 0));
  observer.forget();
  const ObservationResult sight = observer.observe(tests::tag_frame(7, 33'333));
  ASSERT_TRUE(sight.observation.has_value()) << to_string(sight.reason);
  EXPECT_EQ(sight.observation->found_by, FoundBy::frame);
}

TEST(LeaderObserver, DoesNotTakeAStrangersTag) {
  LeaderObserver observer(camera(), {}, body(), {});
  const ObservationResult sight = observer.observe(tests::tag_frame(8));
  EXPECT_FALSE(sight.observation.has_value());
  EXPECT_EQ(sight.reason, Reason::no_tag_of_the_leader);
  EXPECT_EQ(observer.rejected().foreign_id, 1);
}

TEST(LeaderObserver, RefusesAnotherSizeThanTheCalibrations) {
  LeaderObserver observer(camera(), {}, body(), {});
  const Frame frame = Frame::from_pixels(0, 201, 200, std::vector<std::uint8_t>(201 * 200, 200));
  EXPECT_EQ(observer.observe(frame).reason, Reason::frame_size_not_calibrated);
}

TEST(LeaderObserver, IsNotMadeForALeaderWithoutTags) {
  EXPECT_THROW(LeaderObserver(camera(), {}, LeaderBody{}, {}), ConfigError);
  LeaderBody twice = body();
  twice.tags.push_back(twice.tags[0]);
  EXPECT_THROW(LeaderObserver(camera(), {}, twice, {}), ConfigError);
  LeaderBody beyond = body();
  beyond.tags[0].id = 587;  // the family has 0 to 586
  EXPECT_THROW(LeaderObserver(camera(), {}, beyond, {}), ConfigError);
}

std::int64_t ticking_ns() noexcept {
  static std::int64_t now_ns = 0;
  return now_ns += 1000;
}

TEST(LeaderObserver, TimesItsStagesWithTheClockItIsGiven) {
  LeaderObserver observer(camera(), {}, body(), {});
  observer.time_stages(ticking_ns);
  ASSERT_TRUE(observer.observe(tests::tag_frame(7, 0)).observation.has_value());
  for (std::size_t i = 0; i < kStages; ++i) EXPECT_EQ(observer.stages().ns(static_cast<Stage>(i)), 1000) << i;
  // The clock is looked at once a stage, and what is followed is not detected.
  ASSERT_TRUE(observer.observe(tests::tag_frame(7, 33'333)).observation.has_value());
  for (std::size_t i = 0; i < kStages; ++i) {
    const auto stage = static_cast<Stage>(i);
    EXPECT_EQ(observer.stages().ns(stage), stage == Stage::detect ? 0 : 1000) << to_string(stage);
  }
}

TEST(LeaderObserver, LooksAtNoClockUnlessItIsGivenOne) {
  LeaderObserver observer(camera(), {}, body(), {});
  ASSERT_TRUE(observer.observe(tests::tag_frame(7, 0)).observation.has_value());
  for (std::size_t i = 0; i < kStages; ++i) EXPECT_EQ(observer.stages().ns(static_cast<Stage>(i)), 0) << i;
}

TEST(LeaderObserver, SeesTheSameToTheBitWhetherTimedOrNot) {
  LeaderObserver timed(camera(), {}, body(), {}), untimed(camera(), {}, body(), {});
  timed.time_stages(ticking_ns);
  for (int k = 0; k < 3; ++k) {
    const auto a = timed.observe(tests::tag_frame(7, 33'333 * k)), b = untimed.observe(tests::tag_frame(7, 33'333 * k));
    ASSERT_TRUE(a.observation && b.observation);
    EXPECT_EQ(a.observation->distance_m, b.observation->distance_m);
    EXPECT_EQ(a.observation->covariance, b.observation->covariance);
    EXPECT_EQ(a.observation->cMo.matrix(), b.observation->cMo.matrix());
  }
}

TEST(RejectionCounters, CountATagThatWasNotFoundAsNothing) {
  RejectionCounters counters;
  EXPECT_EQ(counters.count(TagRefusal::not_found, Reason::no_tag_found), Reason::no_tag_found);
  for (const auto& named : RejectionCounters::all()) EXPECT_EQ(counters.*named.count, 0) << named.name;
  EXPECT_EQ(counters.count(TagRefusal::margin, Reason::no_tag_found), Reason::tag_refused);
  EXPECT_EQ(counters.margin, 1);
}

TEST(RejectionCounters, AreNamedEachOnce) {
  RejectionCounters counters;
  for (const auto& named : RejectionCounters::all()) ++(counters.*named.count);
  for (const auto& named : RejectionCounters::all()) EXPECT_EQ(counters.*named.count, 1) << named.name;
}

TEST(RejectionCounters, CountAPoseByItsReasonAndAsAPoseWhereThereIsNone) {
  RejectionCounters counters;
  counters.count_pose(Reason::leader_jumped);
  EXPECT_EQ(counters.jump, 1);
  EXPECT_EQ(counters.pose, 0);
  counters.count_pose(Reason::internal_error);  // no counter's reason
  EXPECT_EQ(counters.pose, 1);
  std::int64_t all = 0;
  for (const auto& named : RejectionCounters::all()) all += counters.*named.count;
  EXPECT_EQ(all, 2);
}

TEST(RejectionCounters, AreAddedAndComparedCounterByCounter) {
  // 1, 2, 3, ... beside ..., 3, 2, 1: each sum is one more than their number, each larger one at least half of that.
  RejectionCounters rising, falling;
  std::int64_t number = 0;
  const auto count = static_cast<std::int64_t>(RejectionCounters::kCount);
  for (const auto& named : RejectionCounters::all()) {
    rising.*named.count = ++number;
    falling.*named.count = count + 1 - number;
  }
  const RejectionCounters sum = sum_of(rising, falling), larger = larger_of_each(rising, falling);
  number = 0;
  for (const auto& named : RejectionCounters::all()) {
    ++number;
    EXPECT_EQ(sum.*named.count, count + 1) << named.name;
    EXPECT_EQ(larger.*named.count, std::max(number, count + 1 - number)) << named.name;
  }
}

}  // namespace
