#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pilotfish/core/frame.hpp"

namespace pilotfish::bus {

/// Quality at which an AprilTag's edges still have their sub-pixel position: at 95 the quantisation noise is
/// about one gray level.
inline constexpr int kJpegQuality = 95;

/// The picture as one baseline JPEG; empty if it cannot be encoded.
std::vector<std::uint8_t> encode_jpeg(const ImageView& image);

/// Gray pixels (stride = width) of a JPEG, gray or colour; nothing if it is damaged, or not of exactly this
/// size. The header is checked before anything is allocated or decoded, so a decompression bomb costs nothing.
std::optional<std::vector<std::uint8_t>> decode_jpeg(const std::uint8_t* data, std::size_t size_bytes, int width,
                                                     int height);

}  // namespace pilotfish::bus
