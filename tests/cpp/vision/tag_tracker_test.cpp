#include "pilotfish/vision/tag_tracker.hpp"

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

#include "memory_asked_for.hpp"
#include "refused_key.hpp"
#include "tag_picture.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::vision;
using pilotfish::tests::refused_key;

static_assert(std::is_copy_constructible_v<TagTracker> && std::is_nothrow_move_constructible_v<TagTracker>);
static_assert(noexcept(std::declval<const TagTracker&>().track(std::declval<const ImageView&>(),
                                                               std::declval<const TagPrediction&>(),
                                                               std::declval<const Appearance&>())));

CameraModel camera() { return {tests::kPictureSide_px, tests::kPictureSide_px, 400.0, 400.0, 99.5, 99.5}; }

/// The tag of the picture and one that is not in it, on the other side of the body.
LeaderBody body() {
  LeaderBody body;
  body.tags.resize(2);
  body.tags[0].id = 7;
  body.tags[1].id = 8;
  body.tags[1].facing_rad = 0.0;  // ahead, where a tag on the back faces pi
  return body;
}

/// The black square covers the pixels 68 to 131: its edges are at 67.5 and 131.5.
std::array<Eigen::Vector2d, 4> corners_px() {
  return {Eigen::Vector2d(67.5, 131.5), {131.5, 131.5}, {131.5, 67.5}, {67.5, 67.5}};
}

/// The camera looks along the leader's x axis from a metre behind it, where 64 px are 0.16 m at fx = 400.
Eigen::Isometry3d a_metre_ahead() {
  Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();
  cMo.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  cMo.translation() << 0.0, 0.0, 1.0;
  return cMo;
}

std::int64_t ticking_ns() noexcept {
  static std::int64_t now_ns = 0;
  return now_ns += 1000;
}

TEST(TagTracker, PredictsATagWhereItsCornersAre) {
  const TagTracker tracker(camera(), body());
  const auto prediction = tracker.predict(0, a_metre_ahead());
  ASSERT_TRUE(prediction.has_value());
  EXPECT_TRUE((prediction->nHt / prediction->nHt(2, 2)).isApprox(tracker.predict(0, corners_px()).nHt, 1e-9));
  // Four cells of 8 px are nearer than 40 px.
  EXPECT_NEAR(prediction->search_px, 4 * 8.0, 1e-9);
}

TEST(TagTracker, PredictsNoTagThatCannotBeSeen) {
  const TagTracker tracker(camera(), body());
  EXPECT_FALSE(tracker.predict(1, a_metre_ahead()).has_value());  // its back
  Eigen::Isometry3d behind = a_metre_ahead();
  behind.translation().z() = -1.0;
  EXPECT_FALSE(tracker.predict(0, behind).has_value());
}

TEST(TagTracker, ItsStagesInARowAreTrack) {
  const TagTracker tracker(camera(), body());
  const Frame frame = tests::tag_frame(7);
  auto aside_px = corners_px();
  for (Eigen::Vector2d& corner : aside_px) corner += Eigen::Vector2d(16.0, -9.0);  // two cells: too far for a fit
  const TagPrediction prediction = tracker.predict(0, aside_px, 24.0);
  const auto start = tracker.search(frame.image, prediction);
  ASSERT_TRUE(start);
  const auto fit = tracker.align(frame.image, 0, *start, {});
  ASSERT_TRUE(fit);
  const auto by_stages = tracker.read(frame.image, 0, *fit);
  const auto at_once = tracker.track(frame.image, prediction, {});
  ASSERT_TRUE(by_stages && at_once);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(by_stages->tag.corners_px[i], at_once->tag.corners_px[i]);
    EXPECT_LT((at_once->tag.corners_px[i] - corners_px()[i]).norm(), 0.05) << i;
  }
}

TEST(TagTracker, MeasuresATagOfWhichAPartIsInTheShadow) {
  // Four tenths of the light, on either side of a line through the middle of a cell: the white of the one part (80) is
  // nearer to the black of the other (30) than to its white (200). The line is one edge beside some ten of the tag's
  // own, off by half a cell of 8 px: it may pull a corner by a tenth of a cell.
  const TagTracker tracker(camera(), body());
  for (const bool across : {true, false})
    for (const bool before : {true, false})
      for (const int line : {88, 104, 120}) {
        std::vector<std::uint8_t> pixels = tests::tag_picture(7);
        for (int v = 0; v < tests::kPictureSide_px; ++v)
          for (int u = 0; u < tests::kPictureSide_px; ++u) {
            std::uint8_t& pixel = pixels[static_cast<std::size_t>(v * tests::kPictureSide_px + u)];
            if (((across ? u : v) < line) == before) pixel = static_cast<std::uint8_t>(0.4 * pixel);
          }
        const Frame frame = Frame::from_pixels(0, tests::kPictureSide_px, tests::kPictureSide_px, std::move(pixels));
        const auto measured = tracker.track(frame.image, tracker.predict(0, corners_px()), {});
        ASSERT_TRUE(measured) << across << before << line;
        EXPECT_EQ(measured->tag.hamming, 0) << across << before << line;
        for (std::size_t i = 0; i < 4; ++i)
          EXPECT_LT((measured->tag.corners_px[i] - corners_px()[i]).norm(), 0.8) << across << before << line;
      }
}

TEST(TagTracker, RefusesAFitThatLeavesTooMuchUnexplained) {
  // A quarter of the pixels may be something else's, and 0.12 of the contrast may be left; neither excuses the other.
  const TagTracker tracker(camera(), body());
  const Frame frame = tests::tag_frame(7);
  const auto fit = tracker.align(frame.image, 0, tracker.predict(0, corners_px()).nHt, {});
  ASSERT_TRUE(fit);
  struct {
    double outlier_share, residual;
    bool accepted;
  } const cases[] = {{0.24, 0.0, true}, {0.26, 0.0, false}, {0.0, 0.119, true}, {0.0, 0.121, false}};
  for (const auto& each : cases) {
    Registration claimed = *fit;
    claimed.outlier_share = each.outlier_share;
    claimed.residual_rms = each.residual * fit->appearance.contrast();
    const auto measured = tracker.read(frame.image, 0, claimed);
    EXPECT_EQ(static_cast<bool>(measured), each.accepted) << each.outlier_share << ", " << each.residual;
    if (each.accepted) continue;
    EXPECT_EQ(measured.refusal, TagRefusal::residual);
  }
}

TEST(TagTracker, ReadsThatItIsAnotherTag) {
  LeaderBody other = body();
  other.tags[0].id = 9;
  const TagTracker tracker(camera(), other);
  const auto outcome = tracker.track(tests::tag_frame(7).image, tracker.predict(0, corners_px()), {});
  EXPECT_FALSE(outcome);
}

TEST(TagTracker, FindsNothingWhereThereIsNothing) {
  const TagTracker tracker(camera(), body());
  const Frame blank = Frame::from_pixels(0, 200, 200, std::vector<std::uint8_t>(200 * 200, 128));
  const auto outcome = tracker.search(blank.image, tracker.predict(0, corners_px()));
  EXPECT_FALSE(outcome);
  EXPECT_EQ(outcome.refusal, TagRefusal::not_found);
}

TEST(TagTracker, AsksForNoMemory) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  const TagTracker tracker(camera(), body());
  const Frame frame = tests::tag_frame(7);
  const TagPrediction prediction = tracker.predict(0, corners_px());
  EXPECT_EQ(tests::memory_asked_for([&] { tracker.track(frame.image, prediction, {}); }), 0);
}

TEST(TagTracker, KnowsItsTagsById) {
  const TagTracker tracker(camera(), body());
  EXPECT_EQ(tracker.find(8), std::optional<std::size_t>(1));
  EXPECT_EQ(tracker.find(9), std::nullopt);
}

TEST(TagTracker, IsNotMadeOfWhatCannotBe) {
  LeaderBody wrong = body();
  wrong.tags[1].id = 587;  // the family has 0 to 586
  try {
    TagTracker(camera(), wrong);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.key(), "leader.tags[1].id");
    EXPECT_NE(std::string(error.what()).find("0 to 586"), std::string::npos) << error.what();
  }
  TagGates gates;
  gates.min_cell_px = 0.0;
  EXPECT_EQ(refused_key([&] { TagTracker(camera(), body(), {}, gates); }), "vision.min_cell_px");
  CameraModel flat = camera();
  flat.fx = 0.0;
  EXPECT_EQ(refused_key([&] { TagTracker(flat, body()); }), "camera.fx");
}

TEST(StageStopwatch, TimesEachStageFromTheOneBefore) {
  const TagTracker tracker(camera(), body());
  const Frame frame = tests::tag_frame(7);
  StageStopwatch stopwatch(ticking_ns);
  stopwatch.start();
  // Every look at that clock takes a microsecond, and there is one a stage.
  ASSERT_TRUE(tracker.track(frame.image, tracker.predict(0, corners_px()), {}, &stopwatch));
  for (const Stage stage : {Stage::search, Stage::align, Stage::read}) EXPECT_EQ(stopwatch.ns(stage), 1000);
  for (const Stage stage : {Stage::predict, Stage::detect, Stage::pose}) EXPECT_EQ(stopwatch.ns(stage), 0);
  stopwatch.start();
  EXPECT_EQ(stopwatch.ns(Stage::align), 0);
}

TEST(StageStopwatch, WithoutAClockMeasuresNothing) {
  StageStopwatch stopwatch;
  stopwatch.start();
  stopwatch.lap(Stage::align);
  EXPECT_EQ(stopwatch.ns(Stage::align), 0);
  EXPECT_FALSE(stopwatch.runs());
}

}  // namespace
