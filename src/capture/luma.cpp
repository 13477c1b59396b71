#include "luma.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "pilotfish/jpeg/jpeg.hpp"

namespace pilotfish::capture {
namespace {

/// Where the luma of an uncompressed format lies: from `first_byte` of a row, every `step_bytes`. Planar formats
/// have it in a plane of its own, in front, followed by half as many bytes of colour.
struct Format {
  std::uint32_t fourcc;
  const char* name;
  int first_byte;
  int step_bytes;  ///< 0: JPEG
  bool colour_behind;
};

constexpr std::array<Format, 10> kFormats = {{
    {V4L2_PIX_FMT_GREY, "GREY", 0, 1, false},
    {V4L2_PIX_FMT_YUYV, "YUYV", 0, 2, false},
    {V4L2_PIX_FMT_YVYU, "YVYU", 0, 2, false},
    {V4L2_PIX_FMT_UYVY, "UYVY", 1, 2, false},
    {V4L2_PIX_FMT_NV12, "NV12", 0, 1, true},
    {V4L2_PIX_FMT_NV21, "NV21", 0, 1, true},
    {V4L2_PIX_FMT_YUV420, "YU12", 0, 1, true},
    {V4L2_PIX_FMT_YVU420, "YV12", 0, 1, true},
    {V4L2_PIX_FMT_MJPEG, "MJPG", 0, 0, false},
    {V4L2_PIX_FMT_JPEG, "JPEG", 0, 0, false},
}};

/// Some drivers leave the stride out (0).
std::size_t row_bytes(const Format& format, const PixelLayout& layout) {
  return static_cast<std::size_t>(std::max(layout.stride_bytes, layout.width * format.step_bytes));
}

std::size_t whole_picture_bytes(const Format& format, const PixelLayout& layout) {
  const std::size_t plane_bytes = row_bytes(format, layout) * static_cast<std::size_t>(layout.height);
  return format.colour_behind ? plane_bytes + plane_bytes / 2 : plane_bytes;
}

const Format* find(std::uint32_t fourcc) {
  const auto* found =
      std::find_if(kFormats.begin(), kFormats.end(), [fourcc](const Format& f) { return f.fourcc == fourcc; });
  return found == kFormats.end() ? nullptr : found;
}

}  // namespace

const std::vector<std::uint32_t>& readable_formats() {
  static const std::vector<std::uint32_t> codes = [] {
    std::vector<std::uint32_t> all;
    all.reserve(kFormats.size());
    for (const Format& format : kFormats) all.push_back(format.fourcc);
    return all;
  }();
  return codes;
}

const char* name_of(std::uint32_t fourcc) {
  const Format* format = find(fourcc);
  return format ? format->name : "unknown";
}

std::optional<std::vector<std::uint8_t>> luma(const std::uint8_t* data, std::size_t size_bytes,
                                              const PixelLayout& layout) {
  const Format* format = find(layout.fourcc);
  if (!format || layout.width < 1 || layout.height < 1) return std::nullopt;
  if (format->step_bytes == 0) return jpeg::decode(data, size_bytes, {layout.width, layout.height});
  if (size_bytes < whole_picture_bytes(*format, layout)) return std::nullopt;

  const std::size_t stride = row_bytes(*format, layout);
  const auto width = static_cast<std::size_t>(layout.width);
  std::vector<std::uint8_t> pixels(width * static_cast<std::size_t>(layout.height));
  for (int v = 0; v < layout.height; ++v) {
    const std::uint8_t* row = data + static_cast<std::size_t>(v) * stride;
    std::uint8_t* out = pixels.data() + static_cast<std::size_t>(v) * width;
    if (format->step_bytes == 1) {
      std::memcpy(out, row, width);
    } else {
      for (std::size_t u = 0; u < width; ++u) out[u] = row[static_cast<std::size_t>(format->first_byte) + 2 * u];
    }
  }
  return pixels;
}

}  // namespace pilotfish::capture
