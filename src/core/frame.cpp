#include "pilotfish/core/frame.hpp"

#include <utility>

namespace pilotfish {

Reason check(const ImageView& image) noexcept {
  if (image.width < kMinFrameSide || image.height < kMinFrameSide) return Reason::frame_too_small;
  if (image.width > kMaxFrameSide || image.height > kMaxFrameSide) return Reason::frame_too_large;
  if (image.stride_bytes < image.width) return Reason::frame_stride_invalid;
  // The last row need not be padded up to the stride.
  const std::size_t needed_bytes = static_cast<std::size_t>(image.stride_bytes) * (image.height - 1) + image.width;
  if (image.data == nullptr || image.size_bytes < needed_bytes) return Reason::frame_truncated;
  return Reason::none;
}

Frame Frame::from_pixels(std::int64_t utime, int width, int height, std::vector<std::uint8_t> pixels) {
  auto owner = std::make_shared<const std::vector<std::uint8_t>>(std::move(pixels));
  return Frame{utime, ImageView{owner->data(), owner->size(), width, height, width}, owner};
}

}  // namespace pilotfish
