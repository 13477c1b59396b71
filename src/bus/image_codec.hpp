#pragma once

#include <bot_core/image_t.hpp>
#include <cstddef>

#include "checked.hpp"
#include "pilotfish/core/frame.hpp"

namespace pilotfish::bus {

/// Raw only if the receiver's socket buffer holds a few of them: a picture arrives as one burst of datagrams,
/// and whatever does not fit while the receiver is busy is lost, and the whole picture with it. No buffer
/// (0): no limit.
constexpr bool travels_raw(std::size_t image_bytes, int receive_buffer_bytes) {
  return receive_buffer_bytes == 0 || 4 * image_bytes <= static_cast<std::size_t>(receive_buffer_bytes);
}

/// The message for a picture that passed check(frame.image); nothing if it cannot be encoded.
std::optional<bot_core::image_t> encode_image(const Frame& frame, bool raw);

/// The picture in an encoded bot_core.image_t, converted to gray. Rejections: image_corrupt (not an image_t,
/// or its counts contradict its size), image_size_mismatch, image_too_large, image_format_unknown,
/// image_jpeg_refused, image_time_invalid.
Checked<Frame> decode_image(const void* data, std::size_t size_bytes);

}  // namespace pilotfish::bus
