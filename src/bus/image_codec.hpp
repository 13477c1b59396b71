#pragma once

#include <bot_core/image_t.hpp>
#include <cstddef>

#include "checked.hpp"
#include "pilotfish/bus/encoded_image.hpp"

namespace pilotfish::bus {

/// Raw only if the receiver's socket buffer holds a few of them: a picture arrives as one burst of datagrams,
/// and whatever does not fit while the receiver is busy is lost, and the whole picture with it. No buffer
/// (0): no limit.
constexpr bool travels_raw(std::size_t image_bytes, int receive_buffer_bytes) {
  return receive_buffer_bytes == 0 || 4 * image_bytes <= static_cast<std::size_t>(receive_buffer_bytes);
}

/// The message for a picture that passed check(frame.image); nothing if it cannot be encoded.
std::optional<bot_core::image_t> encode_image(const Frame& frame, bool raw);
/// The same as a smaller JPEG, see Bus::publish_preview.
std::optional<bot_core::image_t> encode_preview(const Frame& frame, int shrink, int quality);

/// The header of a bot_core.image_t, and where its bytes lie.
struct ImageHeader {
  std::int64_t utime = 0;
  std::int32_t width = 0, height = 0, row_stride = 0, pixelformat = 0;
  std::size_t data_offset = 0, data_bytes = 0;
};

/// Everything that can be checked without a look at the pixels. Rejections: image_corrupt (not an image_t, or its
/// counts contradict its size), image_size_mismatch, image_too_large, image_format_unknown, image_time_invalid.
Checked<ImageHeader> read_image_header(const void* data, std::size_t size_bytes);

/// The picture in an encoded bot_core.image_t, converted to gray. Rejections: those of its header, and
/// image_jpeg_refused.
Checked<Frame> decode_image(const void* data, std::size_t size_bytes);

/// The same of a message that is shared: raw gray pixels stay where they are.
Checked<Frame> decode_image(const std::shared_ptr<const std::vector<std::uint8_t>>& message);

}  // namespace pilotfish::bus
