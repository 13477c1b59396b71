#include "image_codec.hpp"

#include <algorithm>
#include <utility>

#include "pilotfish/jpeg/jpeg.hpp"
#include "wire_reader.hpp"

namespace pilotfish::bus {
namespace {

using bot_core::image_t;

constexpr std::int32_t kMaxMetadataEntries = 256;
constexpr std::size_t kDataOffset = 8 /* fingerprint */ + 8 /* utime */ + 4 * 4 /* width to format */ + 4 /* size */;

/// Walks over the whole message; false if its counts do not add up to its size.
bool walk(const void* data, std::size_t size_bytes, ImageHeader& header) {
  WireReader reader(data, size_bytes);
  std::int64_t fingerprint = 0;
  std::int32_t data_bytes = 0, metadata_count = 0;
  if (!reader.read(fingerprint) || fingerprint != image_t::getHash() || !reader.read(header.utime) ||
      !reader.read(header.width) || !reader.read(header.height) || !reader.read(header.row_stride) ||
      !reader.read(header.pixelformat) || !reader.read(data_bytes) || data_bytes < 0)
    return false;
  header.data_offset = kDataOffset;
  header.data_bytes = static_cast<std::size_t>(data_bytes);
  if (!reader.skip(header.data_bytes) || !reader.read(metadata_count)) return false;
  if (metadata_count < 0 || metadata_count > kMaxMetadataEntries) return false;
  for (std::int32_t i = 0; i < metadata_count; ++i)
    if (!reader.skip_string() || !reader.skip_byte_array()) return false;
  return reader.at_end();
}

/// Do stride and size fit a raw picture? The last row need not be padded up to the stride.
bool is_raw_layout_sound(const ImageHeader& image, int bytes_per_pixel) {
  const std::int64_t row_bytes = std::int64_t{image.width} * bytes_per_pixel;
  const std::int64_t padded_bytes = std::int64_t{image.row_stride} * image.height;
  const auto data_bytes = static_cast<std::int64_t>(image.data_bytes);
  return image.row_stride >= row_bytes && data_bytes <= padded_bytes &&
         data_bytes >= padded_bytes - image.row_stride + row_bytes;
}

/// ITU-R BT.601 luma in 16-bit fixed point; the weights add up to 65536, so gray stays gray.
std::vector<std::uint8_t> gray_from_colour(const ImageHeader& image, const std::uint8_t* data, int red, int blue) {
  std::vector<std::uint8_t> gray(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::uint8_t* out = gray.data();
  for (int v = 0; v < image.height; ++v) {
    const std::uint8_t* pixel = data + static_cast<std::size_t>(v) * static_cast<std::size_t>(image.row_stride);
    for (int u = 0; u < image.width; ++u, pixel += 3)
      *out++ = static_cast<std::uint8_t>((19595 * pixel[red] + 38470 * pixel[1] + 7471 * pixel[blue] + 32768) >> 16);
  }
  return gray;
}

/// Means of squares of `factor` x `factor` pixels; what is left at the right and below is cut off.
std::vector<std::uint8_t> shrunk(const ImageView& image, int factor) {
  const int width = image.width / factor, height = image.height / factor, area = factor * factor;
  std::vector<std::uint8_t> out;
  out.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<int> sums(static_cast<std::size_t>(width));
  for (int v = 0; v < height; ++v) {
    std::fill(sums.begin(), sums.end(), area / 2);  // rounds
    for (int row = 0; row < factor; ++row) {
      const std::uint8_t* pixel = image.data + static_cast<std::size_t>(v * factor + row) * image.stride_bytes;
      for (int& sum : sums)
        for (int column = 0; column < factor; ++column) sum += *pixel++;
    }
    for (const int sum : sums) out.push_back(static_cast<std::uint8_t>(sum / area));
  }
  return out;
}

/// Of a message with this header. `owner` keeps its bytes alive; without one, raw pixels are copied.
Checked<Frame> decode(const ImageHeader& header, const std::uint8_t* message, std::shared_ptr<const void> owner) {
  using Result = Checked<Frame>;
  const std::uint8_t* data = message + header.data_offset;
  const auto frame_of = [&](std::vector<std::uint8_t> pixels) {
    return Result::accept(Frame::from_pixels(header.utime, header.width, header.height, std::move(pixels)));
  };
  switch (header.pixelformat) {
    case image_t::PIXEL_FORMAT_GRAY: {
      if (!owner) {
        auto copy = std::make_shared<const std::vector<std::uint8_t>>(data, data + header.data_bytes);
        data = copy->data();
        owner = std::move(copy);
      }
      Frame frame;
      frame.utime = header.utime;
      frame.image = {data, header.data_bytes, header.width, header.height, header.row_stride};
      frame.pixels_owner = std::move(owner);
      return Result::accept(std::move(frame));
    }
    case image_t::PIXEL_FORMAT_RGB: return frame_of(gray_from_colour(header, data, 0, 2));
    case image_t::PIXEL_FORMAT_BGR: return frame_of(gray_from_colour(header, data, 2, 0));
    default: {  // MJPEG: the header has passed its check
      auto pixels = jpeg::decode(data, header.data_bytes, {header.width, header.height});
      if (!pixels) return Result::reject("image_jpeg_refused");
      return frame_of(std::move(*pixels));
    }
  }
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

std::optional<image_t> encode_preview(const Frame& frame, int shrink, int quality) {
  const std::vector<std::uint8_t> pixels = shrunk(frame.image, shrink);
  const ImageView small{pixels.data(), pixels.size(), frame.image.width / shrink, frame.image.height / shrink,
                        frame.image.width / shrink};
  image_t image;
  image.data = jpeg::encode(small, quality);
  if (image.data.empty()) return std::nullopt;
  image.utime = frame.utime;
  image.width = image.row_stride = small.width;
  image.height = small.height;
  image.pixelformat = image_t::PIXEL_FORMAT_MJPEG;
  image.size = static_cast<std::int32_t>(image.data.size());
  const std::string factor = std::to_string(shrink);
  bot_core::image_metadata_t extra;
  extra.key = "pilotfish_shrink";
  extra.value.assign(factor.begin(), factor.end());
  extra.n = static_cast<std::int32_t>(extra.value.size());
  image.metadata.push_back(std::move(extra));
  image.nmetadata = 1;
  return image;
}

Checked<ImageHeader> read_image_header(const void* data, std::size_t size_bytes) {
  using Result = Checked<ImageHeader>;
  ImageHeader header;
  if (!walk(data, size_bytes, header)) return Result::reject("image_corrupt");
  if (header.width < 1 || header.height < 1) return Result::reject("image_size_mismatch");
  if (header.width > kMaxFrameSide || header.height > kMaxFrameSide) return Result::reject("image_too_large");
  if (!is_usable_time(header.utime)) return Result::reject("image_time_invalid");
  switch (header.pixelformat) {
    case image_t::PIXEL_FORMAT_GRAY:
      return is_raw_layout_sound(header, 1) ? Result::accept(header) : Result::reject("image_size_mismatch");
    case image_t::PIXEL_FORMAT_RGB:
    case image_t::PIXEL_FORMAT_BGR:
      return is_raw_layout_sound(header, 3) ? Result::accept(header) : Result::reject("image_size_mismatch");
    case image_t::PIXEL_FORMAT_MJPEG: return Result::accept(header);
    default: return Result::reject("image_format_unknown");
  }
}

Checked<Frame> decode_image(const void* data, std::size_t size_bytes) {
  const auto header = read_image_header(data, size_bytes);
  if (!header.value) return Checked<Frame>::reject(header.rejection);
  return decode(*header.value, static_cast<const std::uint8_t*>(data), nullptr);
}

Checked<Frame> decode_image(const std::shared_ptr<const std::vector<std::uint8_t>>& message) {
  const auto header = read_image_header(message->data(), message->size());
  if (!header.value) return Checked<Frame>::reject(header.rejection);
  return decode(*header.value, message->data(), message);
}

std::optional<Frame> decode(const EncodedImage& image, std::string_view& rejection) {
  if (!image.message) {
    rejection = "image_corrupt";
    return std::nullopt;
  }
  Checked<Frame> checked = decode_image(image.message);
  rejection = checked.rejection;
  return std::move(checked.value);
}

std::optional<Frame> decode(const EncodedImage& image, ImageSize expected, std::string_view& rejection) {
  if (image.width == expected.width && image.height == expected.height) return decode(image, rejection);
  rejection = "image_size_unexpected";
  return std::nullopt;
}

}  // namespace pilotfish::bus
