#include "image_codec.hpp"

#include <algorithm>
#include <limits>

#include "pilotfish/jpeg/jpeg.hpp"
#include "wire_reader.hpp"

namespace pilotfish::bus {
namespace {

using bot_core::image_t;

constexpr std::int32_t kMaxMetadataEntries = 256;

bool is_sound(const void* data, std::size_t size_bytes) {
  WireReader reader(data, size_bytes);
  constexpr std::size_t kFixed = 8 /* fingerprint */ + 8 /* utime */ + 4 * 4 /* width, height, stride, format */;
  std::int32_t metadata_count = 0;
  if (!reader.skip(kFixed) || !reader.skip_byte_array() || !reader.read(metadata_count)) return false;
  if (metadata_count < 0 || metadata_count > kMaxMetadataEntries) return false;
  for (std::int32_t i = 0; i < metadata_count; ++i)
    if (!reader.skip_string() || !reader.skip_byte_array()) return false;
  return reader.at_end();
}

/// Do stride and size fit a raw picture? The last row need not be padded up to the stride.
bool is_raw_layout_sound(const image_t& image, int bytes_per_pixel) {
  const std::int64_t row_bytes = std::int64_t{image.width} * bytes_per_pixel;
  const std::int64_t padded_bytes = std::int64_t{image.row_stride} * image.height;
  return image.row_stride >= row_bytes && image.size <= padded_bytes &&
         image.size >= padded_bytes - image.row_stride + row_bytes;
}

/// ITU-R BT.601 luma in 16-bit fixed point; the weights add up to 65536, so gray stays gray.
std::vector<std::uint8_t> gray_from_colour(const image_t& image, int red, int blue) {
  std::vector<std::uint8_t> gray(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::uint8_t* out = gray.data();
  for (int v = 0; v < image.height; ++v) {
    const std::uint8_t* pixel = image.data.data() + static_cast<std::size_t>(v) * image.row_stride;
    for (int u = 0; u < image.width; ++u, pixel += 3)
      *out++ = static_cast<std::uint8_t>((19595 * pixel[red] + 38470 * pixel[1] + 7471 * pixel[blue] + 32768) >> 16);
  }
  return gray;
}

}  // namespace

std::optional<image_t> encode_image(const Frame& frame, bool raw) {
  const ImageView& view = frame.image;
  image_t image;
  image.utime = frame.utime;
  image.width = view.width;
  image.height = view.height;
  image.row_stride = view.width;
  image.nmetadata = 0;
  if (raw) {
    image.pixelformat = image_t::PIXEL_FORMAT_GRAY;
    image.data.resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
    for (int v = 0; v < view.height; ++v)
      std::copy_n(view.data + static_cast<std::size_t>(v) * view.stride_bytes, view.width,
                  image.data.data() + static_cast<std::size_t>(v) * view.width);
  } else {
    image.pixelformat = image_t::PIXEL_FORMAT_MJPEG;
    image.data = jpeg::encode(view);
    if (image.data.empty()) return std::nullopt;
  }
  image.size = static_cast<std::int32_t>(image.data.size());
  return image;
}

Checked<Frame> decode_image(const void* data, std::size_t size_bytes) {
  using Result = Checked<Frame>;
  image_t image;
  if (size_bytes > std::numeric_limits<std::int32_t>::max() || !is_sound(data, size_bytes) ||
      image.decode(data, 0, static_cast<int>(size_bytes)) != static_cast<int>(size_bytes))
    return Result::reject("image_corrupt");
  if (image.width < 1 || image.height < 1) return Result::reject("image_size_mismatch");
  if (image.width > kMaxFrameSide || image.height > kMaxFrameSide) return Result::reject("image_too_large");
  if (!is_usable_time(image.utime)) return Result::reject("image_time_invalid");

  switch (image.pixelformat) {
    case image_t::PIXEL_FORMAT_GRAY: {
      if (!is_raw_layout_sound(image, 1)) return Result::reject("image_size_mismatch");
      Frame frame = Frame::from_pixels(image.utime, image.width, image.height, std::move(image.data));
      frame.image.stride_bytes = image.row_stride;
      return Result::accept(std::move(frame));
    }
    case image_t::PIXEL_FORMAT_RGB:
    case image_t::PIXEL_FORMAT_BGR: {
      if (!is_raw_layout_sound(image, 3)) return Result::reject("image_size_mismatch");
      const bool red_first = image.pixelformat == image_t::PIXEL_FORMAT_RGB;
      return Result::accept(Frame::from_pixels(image.utime, image.width, image.height,
                                               gray_from_colour(image, red_first ? 0 : 2, red_first ? 2 : 0)));
    }
    case image_t::PIXEL_FORMAT_MJPEG: {
      auto pixels = jpeg::decode(image.data.data(), image.data.size(), {image.width, image.height});
      if (!pixels) return Result::reject("image_jpeg_refused");
      return Result::accept(Frame::from_pixels(image.utime, image.width, image.height, std::move(*pixels)));
    }
    default: return Result::reject("image_format_unknown");
  }
}

}  // namespace pilotfish::bus
