#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "pilotfish/core/frame.hpp"

namespace pilotfish::vision {

/// Largest less smallest gray of a square of the picture, which must lie within it.
inline std::uint8_t gray_range(const ImageView& image, int left, int top, int side_px) {
  const std::uint8_t* first = image.data + static_cast<std::ptrdiff_t>(top) * image.stride_bytes + left;
  std::uint8_t low = 255, high = 0;
  for (int j = 0; j < side_px; ++j, first += image.stride_bytes)
    for (int i = 0; i < side_px; ++i) {
      low = std::min(low, first[i]);
      high = std::max(high, first[i]);
    }
  return high - low;
}

/// The gray level that one in `parts` of the `count` counted ones does not exceed: 2 for the median.
inline int quantile_of(const std::array<int, 256>& histogram, int count, int parts) {
  int level = 0;
  for (int below = histogram[0]; level < 255 && parts * below < count; below += histogram[++level]) continue;
  return level;
}

}  // namespace pilotfish::vision
