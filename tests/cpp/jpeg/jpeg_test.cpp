#include "pilotfish/jpeg/jpeg.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace {

using namespace pilotfish;
using namespace pilotfish::jpeg;

constexpr int kWidth = 48, kHeight = 32;

/// Gray levels that rise slowly, which JPEG keeps within a level or two.
std::vector<std::uint8_t> slope() {
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) pixels.push_back(static_cast<std::uint8_t>(60 + 2 * u + v));
  return pixels;
}

std::vector<std::uint8_t> encoded() {
  const std::vector<std::uint8_t> pixels = slope();
  return encode({pixels.data(), pixels.size(), kWidth, kHeight, kWidth});
}

TEST(Jpeg, GivesBackThePictureWithinTwoLevels) {
  const auto bytes = encoded();
  const auto decoded = decode(bytes.data(), bytes.size(), {kWidth, kHeight});
  ASSERT_TRUE(decoded.has_value());
  const auto original = slope();
  ASSERT_EQ(decoded->size(), original.size());
  for (std::size_t i = 0; i < original.size(); ++i) EXPECT_LE(std::abs((*decoded)[i] - original[i]), 2) << i;
}

TEST(Jpeg, EncodesTheRowsAndNotThePaddingBetweenThem) {
  const auto dense = slope();
  std::vector<std::uint8_t> padded((kWidth + 9) * (kHeight - 1) + kWidth, 255);
  for (std::size_t v = 0; v < kHeight; ++v) std::copy_n(&dense[v * kWidth], kWidth, &padded[v * (kWidth + 9)]);
  EXPECT_EQ(encode({padded.data(), padded.size(), kWidth, kHeight, kWidth + 9}), encoded());
}

TEST(Jpeg, EncodesNothingOfNoPicture) {
  EXPECT_TRUE(encode(ImageView{}).empty());
  EXPECT_TRUE(encode({nullptr, 0, kWidth, kHeight, kWidth}).empty());
  const auto pixels = slope();
  EXPECT_TRUE(encode({pixels.data(), pixels.size(), 0, kHeight, kWidth}).empty());
  EXPECT_TRUE(encode({pixels.data(), pixels.size() - 1, kWidth, kHeight, kWidth}).empty());
}

TEST(Jpeg, IsNothingWhereverItIsCutOff) {
  const auto bytes = encoded();
  for (std::size_t size = 0; size + 2 < bytes.size(); ++size) {  // the last two bytes only say that it ends
    const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(decode(cut.data(), cut.size(), {kWidth, kHeight}).has_value()) << size << " of " << bytes.size();
  }
}

TEST(Jpeg, IsNothingWhenAnotherSizeIsExpected) {
  const auto bytes = encoded();
  for (Size size : {Size{kWidth + 1, kHeight}, Size{kWidth, kHeight - 1}, Size{kHeight, kWidth}, Size{0, 0},
                    Size{-kWidth, kHeight}})
    EXPECT_FALSE(decode(bytes.data(), bytes.size(), size).has_value()) << size.width;
}

TEST(Jpeg, ClaimsItsSizeBeforeItIsDecoded) {
  const auto bytes = encoded();
  const auto size = claimed_size(bytes.data(), bytes.size());
  ASSERT_TRUE(size.has_value());
  EXPECT_EQ(size->width, kWidth);
  EXPECT_EQ(size->height, kHeight);
  EXPECT_FALSE(claimed_size(nullptr, 0).has_value());
}

}  // namespace
