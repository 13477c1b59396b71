#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/status.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// Gray pixels, not owned. Pixel (u, v) is data[v * stride_bytes + u]; its CENTRE is at image coordinates
/// (u, v), everywhere in Pilotfish (OpenCV's convention; the tag detector converts AprilTag's).
struct ImageView {
  const std::uint8_t* data = nullptr;  ///< the top-left pixel
  std::size_t size_bytes = 0;          ///< how many bytes may be read at data
  int width = 0;                       ///< [px]
  int height = 0;                      ///< [px]
  int stride_bytes = 0;                ///< from one row to the next
};

/// The sizes a frame may have: below, AprilTag asserts; above, its 16-bit coordinates overflow.
inline constexpr int kMinFrameSide = 16;
inline constexpr int kMaxFrameSide = 16384;

/// Reason::none if the view can be read safely, else what is wrong with it. Never throws, never reads the pixels.
Reason check(const ImageView& image) noexcept;

/// One gray picture and the instant of its exposure. A value: copies share the pixels, which are never changed.
struct Frame {
  std::int64_t utime = 0;                    ///< exposure time [us], on the clock of the computer that took it
  ImageView image;                           ///< the pixels
  std::shared_ptr<const void> pixels_owner;  ///< keeps image.data alive; empty if the caller does
  /// Time known to have passed between exposure and arrival [us]: by a driver's time stamp, or by the wall clock if the
  /// sender shares it. 0: unknown. Negative: the stamp is in the future. It can only make a frame older.
  std::int64_t known_age_us = 0;
  /// The computer does not keep up: where the whole picture has to be searched, it is searched at half the resolution,
  /// which finds nearer leaders only. Set by the caller, so that a replay of the frame gives the same answer.
  bool coarse_search = false;

  /// Takes ownership of the pixels (stride = width). Sizes are not checked here but by check(frame.image), at the use.
  static Frame from_pixels(std::int64_t utime, int width, int height, std::vector<std::uint8_t> pixels);
};

}  // namespace pilotfish
PILOTFISH_API_END
