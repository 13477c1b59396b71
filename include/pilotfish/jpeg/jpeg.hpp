#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::jpeg {

/// Quality at which an AprilTag's edges still have their sub-pixel position: at 95 the quantisation noise is
/// about one gray level.
inline constexpr int kQuality = 95;

/// The required size of a picture.
struct Size {
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
};

/// The picture as one baseline JPEG of this quality (1 to 100); empty if it cannot be encoded, for example because
/// check() refuses it.
std::vector<std::uint8_t> encode(const ImageView& image, int quality = kQuality);

/// The header's sizes, before anything is allocated or decoded; nothing if there is no valid header, or if a side
/// is beyond kMaxFrameSide, or if there are too few bytes for so many pixels (a decompression bomb, or truncated).
std::optional<Size> claimed_size(const std::uint8_t* data, std::size_t size_bytes);

/// Gray pixels (stride = width) of a JPEG, gray or colour: the luma as it was coded, so the very bits that OpenCV and
/// libjpeg give in gray. Nothing if it is damaged, cut off, CMYK, or not of exactly this size: by default a decoder
/// fills missing parts with gray or leaves the last picture's pixels, and a tag in those is no measurement.
std::optional<std::vector<std::uint8_t>> decode(const std::uint8_t* data, std::size_t size_bytes, Size size);

}  // namespace pilotfish::jpeg
PILOTFISH_API_END
