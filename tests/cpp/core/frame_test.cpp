#include "pilotfish/core/frame.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <type_traits>

namespace {

using namespace pilotfish;

static_assert(noexcept(check(std::declval<const ImageView&>())));
static_assert(std::is_same_v<decltype(ImageView::data), const std::uint8_t*>);  // nobody writes through a view
static_assert(std::is_nothrow_move_constructible_v<Frame> && std::is_nothrow_move_assignable_v<Frame>);

constexpr int kMax = std::numeric_limits<int>::max();

/// check() never reads the pixels, so a view of one byte can claim any size.
Reason check_claim(int width, int height, int stride_bytes, std::size_t size_bytes) {
  static const std::uint8_t byte = 0;
  return check(ImageView{&byte, size_bytes, width, height, stride_bytes});
}

TEST(ImageView, IsEmptyAndRefusedUntilItIsFilled) { EXPECT_EQ(check(ImageView{}), Reason::frame_too_small); }

TEST(ImageView, MayBe16PixelsWideAndNoFewer) {
  EXPECT_EQ(check_claim(16, 16, 16, 256), Reason::none);
  EXPECT_EQ(check_claim(15, 16, 16, 256), Reason::frame_too_small);
  EXPECT_EQ(check_claim(16, 15, 16, 256), Reason::frame_too_small);
}

TEST(ImageView, MayBe16384PixelsWideAndNoMore) {
  const std::size_t bytes = std::size_t{16384} * 16384;
  EXPECT_EQ(check_claim(16384, 16384, 16384, bytes), Reason::none);
  EXPECT_EQ(check_claim(16385, 16384, 16385, 2 * bytes), Reason::frame_too_large);
  EXPECT_EQ(check_claim(16384, 16385, 16384, 2 * bytes), Reason::frame_too_large);
}

TEST(ImageView, HasNoNegativeSides) {
  EXPECT_EQ(check_claim(-640, 480, 640, 640 * 480), Reason::frame_too_small);
  EXPECT_EQ(check_claim(640, -480, 640, 640 * 480), Reason::frame_too_small);
  EXPECT_EQ(check_claim(640, 480, -640, 640 * 480), Reason::frame_stride_invalid);
}

TEST(ImageView, NeedsAStrideOfAWholeRow) {
  EXPECT_EQ(check_claim(640, 480, 639, 640 * 480), Reason::frame_stride_invalid);
  EXPECT_EQ(check_claim(640, 480, 640, 640 * 480), Reason::none);
}

TEST(ImageView, NeedsNoPaddingBehindItsLastRow) {
  // 15 rows of 32 bytes and one of 20 pixels: 500 bytes.
  EXPECT_EQ(check_claim(20, 16, 32, 500), Reason::none);
  EXPECT_EQ(check_claim(20, 16, 32, 499), Reason::frame_truncated);
}

TEST(ImageView, DoesNotOverflowWithTheLongestStride) {
  // 2^31 - 1 bytes a row times 16383 rows wraps around in 32 bits.
  EXPECT_EQ(check_claim(16, 16384, kMax, std::size_t{1} << 31), Reason::frame_truncated);
  EXPECT_EQ(check_claim(16, 16384, kMax, std::size_t{kMax} * 16383 + 16), Reason::none);
}

TEST(ImageView, NeedsPixels) {
  EXPECT_EQ(check(ImageView{nullptr, std::numeric_limits<std::size_t>::max(), 640, 480, 640}), Reason::frame_truncated);
}

TEST(Frame, TakesPixelsOverWithoutACopy) {
  std::vector<std::uint8_t> pixels(16 * 16, 7);
  const std::uint8_t* where = pixels.data();
  const Frame frame = Frame::from_pixels(5, 16, 16, std::move(pixels));
  EXPECT_EQ(frame.image.data, where);
  EXPECT_EQ(frame.image.stride_bytes, 16);
  EXPECT_EQ(check(frame.image), Reason::none);
}

TEST(Frame, KeepsItsPixelsForEveryCopy) {
  Frame copy;
  {
    const Frame frame = Frame::from_pixels(5, 16, 16, std::vector<std::uint8_t>(256, 7));
    copy = frame;
    EXPECT_EQ(copy.image.data, frame.image.data);
  }
  EXPECT_EQ(copy.pixels_owner.use_count(), 1);
  EXPECT_EQ(copy.image.data[255], 7);  // freed memory, if nobody kept it
}

TEST(Frame, KeepsItsPixelsWhenItIsMoved) {
  Frame frame = Frame::from_pixels(5, 16, 16, std::vector<std::uint8_t>(256, 7));
  const std::uint8_t* where = frame.image.data;
  Frame moved = std::move(frame);
  EXPECT_EQ(moved.image.data, where);
  EXPECT_EQ(moved.pixels_owner.use_count(), 1);
}

TEST(Frame, IsRefusedWhenThePixelsAreFewerThanItsSizeSays) {
  EXPECT_EQ(check(Frame::from_pixels(0, 16, 17, std::vector<std::uint8_t>(256)).image), Reason::frame_truncated);
  EXPECT_EQ(check(Frame::from_pixels(0, 0, 0, {}).image), Reason::frame_too_small);
}

}  // namespace
