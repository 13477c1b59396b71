// Bytes as a bot_core.image_t. If the first byte is odd, fingerprint and counts are put right, so that what lies behind
// them (layouts, JPEG) is reached.
#include <bot_core/image_t.hpp>
#include <cstring>
#include <numeric>

#include "fuzz_input.hpp"
#include "image_codec.hpp"

using namespace pilotfish;
using namespace pilotfish::bus;

namespace {

constexpr int kLargestSide = 512;  // decoding more takes time and shows nothing new

std::vector<std::uint8_t> made_message(fuzz::FuzzInput& input) {
  using bot_core::image_t;
  constexpr std::int32_t kFormats[] = {image_t::PIXEL_FORMAT_GRAY, image_t::PIXEL_FORMAT_RGB, image_t::PIXEL_FORMAT_BGR,
                                       image_t::PIXEL_FORMAT_MJPEG};
  image_t image;
  image.utime = input.number(1);
  image.pixelformat = kFormats[input.number(1) & 3];
  image.width = static_cast<std::int32_t>(input.number(1));
  image.height = static_cast<std::int32_t>(input.number(1));
  image.row_stride = static_cast<std::int32_t>(input.number(2));
  image.data.assign(input.data(), input.data() + input.left());
  image.size = static_cast<std::int32_t>(image.data.size());
  image.nmetadata = 0;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(image.getEncodedSize()));
  image.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

void read_all(const Frame& frame) {
  const ImageView& view = frame.image;
  fuzz::require(view.width >= 1 && view.height >= 1, "a frame has pixels");
  if (check(view) != Reason::none) return;
  unsigned sum = 0;
  for (int v = 0; v < view.height; ++v) {
    const std::uint8_t* row = view.data + static_cast<std::size_t>(v) * static_cast<std::size_t>(view.stride_bytes);
    sum = std::accumulate(row, row + view.width, sum);
  }
  fuzz::require(sum <= 255u * kLargestSide * kLargestSide, "pixels are bytes");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::FuzzInput input(data, size);
  const bool made = (input.number(1) & 1) != 0;
  const auto message = std::make_shared<const std::vector<std::uint8_t>>(
      made ? made_message(input) : std::vector<std::uint8_t>(input.data(), input.data() + input.left()));
  const auto header = read_image_header(message->data(), message->size());
  if (!header.value || header.value->width > kLargestSide || header.value->height > kLargestSide) return 0;
  const Checked<Frame> shared = decode_image(message);
  const Checked<Frame> copied = decode_image(message->data(), message->size());
  fuzz::require(shared.value.has_value() == copied.value.has_value(), "both ways to decode agree");
  if (!shared.value) return 0;
  fuzz::require(shared.value->utime == header.value->utime, "the header is the picture's");
  read_all(*shared.value);
  read_all(*copied.value);
  return 0;
}
