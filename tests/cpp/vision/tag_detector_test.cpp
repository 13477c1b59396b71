#include "pilotfish/vision/tag_detector.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "refused_key.hpp"
#include "tag_picture.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::vision;

static_assert(std::is_nothrow_move_constructible_v<TagDetector> && std::is_nothrow_move_assignable_v<TagDetector>);
static_assert(!std::is_copy_constructible_v<TagDetector> && !std::is_copy_assignable_v<TagDetector>);
static_assert(noexcept(std::declval<TagDetector&>().detect(std::declval<const ImageView&>())));

/// The ids found in a picture of tag `id`.
std::vector<int> found_in_picture_of(TagDetector& detector, int id) {
  std::vector<int> ids;
  for (const TagDetection& tag : detector.detect(tests::tag_frame(id).image).tags) ids.push_back(tag.id);
  return ids;
}

std::string refused_key(const std::string& family, const TagDetectorConfig& config) {
  return tests::refused_key([&] { TagDetector{family, config}; });
}

TEST(TagDetector, PutsCornersBetweenPixels) {
  // The square covers the pixels 68 to 131; a pixel's centre has its number, so the edges are at 67.5 and 131.5.
  TagDetector detector("tag36h11", {});
  const Detections found = detector.detect(tests::tag_frame(5).image);
  ASSERT_EQ(found.tags.size(), 1U);
  const double bottom_left_first[4][2] = {{67.5, 131.5}, {131.5, 131.5}, {131.5, 67.5}, {67.5, 67.5}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(found.tags[0].corners_px[i].x(), bottom_left_first[i][0], 0.3) << i;
    EXPECT_NEAR(found.tags[0].corners_px[i].y(), bottom_left_first[i][1], 0.3) << i;
  }
}

TEST(TagDetector, DetectsAfterAMove) {
  TagDetector detector("tag36h11", {});
  TagDetector moved = std::move(detector);
  EXPECT_EQ(found_in_picture_of(moved, 7), std::vector<int>{7});
  EXPECT_EQ(moved.family_size(), 587);
}

TEST(TagDetector, TakesFamilyAndConfigurationAlongWhenItIsAssigned) {
  TagDetectorConfig strict;
  strict.min_decision_margin = 255.0;  // more contrast than any picture has
  TagDetector detector("tag25h9", {});
  EXPECT_TRUE(found_in_picture_of(detector, 7).empty());
  detector = TagDetector("tag36h11", {});
  EXPECT_EQ(found_in_picture_of(detector, 7), std::vector<int>{7});
  detector = TagDetector("tag36h11", strict);
  EXPECT_TRUE(found_in_picture_of(detector, 7).empty());
}

TEST(TagDetector, OutlivesAnotherOfTheSameFamily) {
  TagDetector first("tag36h11", {});
  { TagDetector second("tag36h11", {}); }  // frees tables of its own
  EXPECT_EQ(found_in_picture_of(first, 7), std::vector<int>{7});
}

TEST(TagDetector, OnlyReadsThePixels) {
  // In memory that ends the program when it is written to; libapriltag's blur writes into the picture it is given.
  const std::vector<std::uint8_t> pixels = tests::tag_picture(7);
  void* page = ::mmap(nullptr, pixels.size(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(page, MAP_FAILED);
  std::copy(pixels.begin(), pixels.end(), static_cast<std::uint8_t*>(page));
  ASSERT_EQ(::mprotect(page, pixels.size(), PROT_READ), 0);
  const int side = tests::kPictureSide_px;
  for (double decimation : {1.0, 2.0}) {
    TagDetectorConfig config;
    config.blur_sigma_px = 0.8;
    config.decimation = decimation;
    TagDetector detector("tag36h11", config);
    const Detections found = detector.detect({static_cast<const std::uint8_t*>(page), pixels.size(), side, side, side});
    EXPECT_EQ(found.tags.size(), 1U) << decimation;
  }
  ::munmap(page, pixels.size());
}

TEST(TagDetector, ReadsNoByteBehindTheLastRow) {
  // A sanitizer sees the end of the vector. Rows of 208 bytes, of which the last has 200; what stands between them is
  // no part of the picture.
  const std::vector<std::uint8_t> dense = tests::tag_picture(7);
  const std::size_t side = tests::kPictureSide_px, stride = 208;
  std::vector<std::uint8_t> padded(stride * (side - 1) + side);
  for (std::size_t i = 0; i < padded.size(); ++i) padded[i] = static_cast<std::uint8_t>(i * 37);
  for (std::size_t v = 0; v < side; ++v) std::copy_n(&dense[v * side], side, &padded[v * stride]);
  padded.shrink_to_fit();
  TagDetector detector("tag36h11", {});
  const Detections found = detector.detect({padded.data(), padded.size(), 200, 200, 208});
  ASSERT_EQ(found.tags.size(), 1U);
  EXPECT_EQ(found.tags[0].id, 7);
  EXPECT_EQ(found.tags[0].corners_px, detector.detect(tests::tag_frame(7).image).tags.at(0).corners_px);
}

TEST(TagDetector, SaysWhyItDidNotLook) {
  TagDetector detector("tag36h11", {});
  EXPECT_EQ(detector.detect(ImageView{}).input, Reason::frame_too_small);
  ImageView view = tests::tag_frame(7).image;
  --view.size_bytes;
  EXPECT_EQ(detector.detect(view).input, Reason::frame_truncated);
}

TEST(TagDetector, RefusesAPictureThatItsBytesCannotBe) {
  struct {
    std::size_t size_bytes;
    int width, height, stride_bytes;
    Reason reason;
  } const claims[] = {
      {1, 1, 1, 1, Reason::frame_too_small},
      {640, 640, 1, 640, Reason::frame_too_small},
      {640, 1, 640, 1, Reason::frame_too_small},
      {100, -640, 480, 640, Reason::frame_too_small},
      {40000 * 16, 40000, 16, 40000, Reason::frame_too_large},
      {40000 * 16, 16, 40000, 16, Reason::frame_too_large},
      {640 * 480, 640, 480, 639, Reason::frame_stride_invalid},
      {640 * 480, 640, 480, -640, Reason::frame_stride_invalid},
      {640 * 480 - 1, 640, 480, 640, Reason::frame_truncated},
      {640 * 480, 640, 480, 641, Reason::frame_truncated},
      {0, 640, 480, 640, Reason::frame_truncated},
      {1000, 16384, 16384, 2147483647, Reason::frame_truncated},
  };
  TagDetector detector("tag36h11", {});
  for (const auto& claim : claims) {
    const std::vector<std::uint8_t> bytes(claim.size_bytes);
    const Detections found =
        detector.detect({bytes.data(), bytes.size(), claim.width, claim.height, claim.stride_bytes});
    EXPECT_EQ(found.input, claim.reason) << claim.width << " x " << claim.height << ", " << claim.stride_bytes;
    EXPECT_TRUE(found.tags.empty());
  }
}

TEST(TagDetector, IsNotMadeOfWhatCannotWork) {
  EXPECT_EQ(refused_key("tag37h11", {}), "leader.family");
  TagDetectorConfig config;
  config.decimation = 2.5;
  EXPECT_EQ(refused_key("tag36h11", config), "vision.decimation");
  config = {};
  config.blur_sigma_px = std::nan("");
  EXPECT_EQ(refused_key("tag36h11", config), "vision.blur_sigma_px");
  config = {};
  config.max_hamming = 3;
  EXPECT_EQ(refused_key("tag36h11", config), "vision.max_hamming");
}

TEST(TagFamily, MovesWithItsTags) {
  TagFamily family("tag16h5");
  const TagBitmap before = family.bitmap(3);
  TagFamily moved = std::move(family);
  EXPECT_EQ(moved.bitmap(3).pixels, before.pixels);
  EXPECT_EQ(moved.size(), 30);
  EXPECT_EQ(moved.bits(), 16);
}

TEST(TagFamily, HasNoTagBeforeItsFirstAndBehindItsLast) {
  const TagFamily family("tag16h5");
  EXPECT_THROW(family.bitmap(-1), std::out_of_range);
  EXPECT_THROW(family.bitmap(30), std::out_of_range);
  EXPECT_NO_THROW(family.bitmap(29));
}

}  // namespace
