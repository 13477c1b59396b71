#include "pilotfish/jpeg/jpeg.hpp"

#include <turbojpeg.h>

#include <memory>
#include <string_view>

namespace pilotfish::jpeg {
namespace {

struct Destroy {
  void operator()(void* codec) const { tjDestroy(codec); }
};
using Codec = std::unique_ptr<void, Destroy>;

/// A block of 8 x 8 pixels takes at least two bits in a baseline JPEG: one for its DC coefficient, one for
/// "the rest is zero". So one byte holds 256 pixels at most, and a file that claims more is a bomb (or truncated).
constexpr std::size_t kMaxPixelsPerByte = 256;

/// Many USB cameras leave a stray byte before the end marker; the picture is whole. Any other warning means
/// that parts of it were made up by the decoder.
bool is_harmless_warning(tjhandle codec) {
  return tjGetErrorCode(codec) == TJERR_WARNING &&
         std::string_view(tjGetErrorStr2(codec)).find("extraneous bytes before marker") != std::string_view::npos;
}

std::size_t pixel_count(Size size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

std::optional<Size> read_header(tjhandle codec, const std::uint8_t* data, std::size_t size_bytes) {
  Size size;
  int subsampling = 0, colorspace = 0;
  if (tjDecompressHeader3(codec, data, size_bytes, &size.width, &size.height, &subsampling, &colorspace) != 0)
    return std::nullopt;
  if (size.width < 1 || size.height < 1 || size.width > kMaxFrameSide || size.height > kMaxFrameSide ||
      pixel_count(size) / kMaxPixelsPerByte > size_bytes)
    return std::nullopt;
  return size;
}

}  // namespace

std::vector<std::uint8_t> encode(const ImageView& image, int quality) {
  // For an empty picture libjpeg-turbo allocates 2^64 - 1 bytes; an unreadable picture must not reach it.
  if (check(image) != Reason::none) return {};
  const Codec codec(tjInitCompress());
  if (!codec) return {};
  std::vector<std::uint8_t> bytes(tjBufSize(image.width, image.height, TJSAMP_GRAY));
  unsigned char* buffer = bytes.data();
  unsigned long size_bytes = bytes.size();
  if (tjCompress2(codec.get(), image.data, image.width, image.stride_bytes, image.height, TJPF_GRAY, &buffer,
                  &size_bytes, TJSAMP_GRAY, quality, TJFLAG_NOREALLOC | TJFLAG_ACCURATEDCT) != 0)
    return {};
  bytes.resize(size_bytes);
  return bytes;
}

std::optional<Size> claimed_size(const std::uint8_t* data, std::size_t size_bytes) {
  const Codec codec(tjInitDecompress());
  return codec ? read_header(codec.get(), data, size_bytes) : std::nullopt;
}

std::optional<std::vector<std::uint8_t>> decode(const std::uint8_t* data, std::size_t size_bytes, Size size) {
  const Codec codec(tjInitDecompress());
  if (!codec) return std::nullopt;
  const std::optional<Size> real = read_header(codec.get(), data, size_bytes);
  if (!real || real->width != size.width || real->height != size.height) return std::nullopt;

  std::vector<std::uint8_t> pixels(pixel_count(size));
  const int flags = TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS;  // the latter: progressive files may not waste time
  if (tjDecompress2(codec.get(), data, size_bytes, pixels.data(), size.width, size.width, size.height, TJPF_GRAY,
                    flags) != 0 &&
      !is_harmless_warning(codec.get()))
    return std::nullopt;
  return pixels;
}

}  // namespace pilotfish::jpeg
