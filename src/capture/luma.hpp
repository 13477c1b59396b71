#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace pilotfish::capture {

/// How a camera's picture lies in memory, as the driver granted it.
struct PixelLayout {
  std::uint32_t fourcc = 0;
  int width = 0;
  int height = 0;
  int stride_bytes = 0;  ///< of a row of luma; without meaning for JPEG
};

/// The fourcc codes that luma() reads, best first: uncompressed ones before MJPEG, whose block noise moves a tag's
/// edges, and the fewest bytes first.
const std::vector<std::uint32_t>& readable_formats();

/// "YUYV".
const char* name_of(std::uint32_t fourcc);

/// The luma of one picture (stride = width); nothing if it is not whole: fewer bytes than a picture takes, or a JPEG
/// that is damaged, cut off or of another size.
std::optional<std::vector<std::uint8_t>> luma(const std::uint8_t* data, std::size_t size_bytes,
                                              const PixelLayout& layout);

}  // namespace pilotfish::capture
