#pragma once

#include "pilotfish/core/frame.hpp"
#include "pilotfish/vision/tag_family.hpp"

namespace pilotfish::tests {

inline constexpr int kPictureSide_px = 200;

/// A picture of one tag of tag36h11, seen head-on in its middle: 8 pixels a cell, 10 cells with the white border, so
/// that the black square covers the pixels 68 to 131.
inline std::vector<std::uint8_t> tag_picture(int id) {
  std::vector<std::uint8_t> pixels(std::size_t{kPictureSide_px} * kPictureSide_px, 200);
  const vision::TagBitmap tag = vision::TagFamily("tag36h11").bitmap(id);
  for (int v = 0; v < 8 * tag.cells; ++v)
    for (int u = 0; u < 8 * tag.cells; ++u)
      pixels[static_cast<std::size_t>((60 + v) * kPictureSide_px + 60 + u)] =
          tag.pixels[static_cast<std::size_t>(v / 8 * tag.cells + u / 8)] != 0 ? 200 : 30;
  return pixels;
}

inline Frame tag_frame(int id, std::int64_t utime = 0) {
  return Frame::from_pixels(utime, kPictureSide_px, kPictureSide_px, tag_picture(id));
}

}  // namespace pilotfish::tests
