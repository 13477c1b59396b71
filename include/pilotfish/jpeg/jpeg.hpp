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

/// What a picture must measure.
struct Size {
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
};

/// The picture as one baseline JPEG; empty if it cannot be encoded, as what check() refuses.
std::vector<std::uint8_t> encode(const ImageView& image);

/// What the header claims, before anything is allocated or decoded; nothing if there is no sound header, or if a side
/// is beyond kMaxFrameSide, or if so few bytes cannot hold so many pixels (a bomb, or cut off).
std::optional<Size> claimed_size(const std::uint8_t* data, std::size_t size_bytes);

/// Gray pixels (stride = width) of a JPEG, gray or colour: the luma as it was coded, so the very bits that OpenCV and
/// libjpeg give in gray. Nothing if it is damaged, cut off, CMYK, or not of exactly this size: a decoder left to itself
/// fills what is missing with gray, and a tag of the last picture's lower half is no measurement.
std::optional<std::vector<std::uint8_t>> decode(const std::uint8_t* data, std::size_t size_bytes, Size size);

}  // namespace pilotfish::jpeg
PILOTFISH_API_END
