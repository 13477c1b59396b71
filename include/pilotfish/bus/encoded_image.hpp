#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/monotonic.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::bus {

/// A picture as received: type, sizes, format and time are checked, and no pixel has been decoded. So a receiver
/// of more pictures than it can use discards the old ones at no cost.
struct EncodedImage {
  std::int64_t utime = 0;  ///< exposure time [us], on the clock of the computer that took it
  int width = 0;           ///< claimed width [px]
  int height = 0;          ///< claimed height [px]
  bool is_jpeg = false;    ///< else raw gray pixels
  MonotonicTime arrival;   ///< when its first byte reached this host
  std::shared_ptr<const std::vector<std::uint8_t>> message;  ///< bot_core.image_t
};

/// The required size of a picture.
struct ImageSize {
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
};

/// The picture in gray; raw gray shares the message's bytes. Nothing, and why not, if it is damaged (image_corrupt,
/// image_jpeg_refused, ...). Any thread may call it.
std::optional<Frame> decode(const EncodedImage& image, std::string_view& rejection);
/// The same for a picture of the expected size only: another one is image_size_unexpected, and is not decoded.
std::optional<Frame> decode(const EncodedImage& image, ImageSize expected, std::string_view& rejection);

}  // namespace pilotfish::bus
PILOTFISH_API_END
