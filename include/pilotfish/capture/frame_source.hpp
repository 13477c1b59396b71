#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::capture {

/// A source that cannot be opened. The message says what was tried, and the remedy.
class CaptureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How long next() of a live source waits before it returns without a frame. Short, so that the reading thread can be
/// stopped; a camera that is unplugged ends at once.
inline constexpr std::chrono::milliseconds kPatience{250};

/// Pictures, one after the other. next() may wait, so a live source belongs on a thread of its own.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next frame. Nothing: the source has ended(), or it is live and no frame came within kPatience (call again).
  /// A picture that cannot be decoded comes as a frame without pixels (0 x 0), so that it is counted and refused
  /// downstream instead of being lost. Never throws.
  virtual std::optional<Frame> next() = 0;
  /// Why there will be no more frames, as a line for the log; empty while there may be. A live source that has ended
  /// (unplugged, silent for seconds) can only be reopened.
  virtual std::string why_ended() const = 0;
  bool ended() const { return !why_ended().empty(); }  ///< there will be no more frames
  /// Frames arrive independently of the calls of next(): use the newest. Otherwise every frame matters.
  virtual bool live() const = 0;
  /// One line for the log, e.g. "images in data/run1 (300 pictures, 30 Hz)".
  virtual std::string describe() const = 0;
};

/// Video4Linux camera by number, set to the calibration's size. A frame's known_age_us is the time from the driver's
/// stamp (exposure, or the picture's last byte where the driver stamps that) to the return of next(); its utime is the
/// wall clock at the exposure. Only the newest picture is delivered; one that the driver marks as damaged, or that is
/// incomplete, comes without pixels.
std::unique_ptr<FrameSource> open_camera(int index, int width, int height, double frame_rate_hz);
/// Video file; frames carry the file's own timestamps.
std::unique_ptr<FrameSource> open_video(const std::string& path);
/// Files that open_images() reads, by the end of their names; capitals too.
inline constexpr std::array<std::string_view, 9> kPictureSuffixes = {".png", ".jpg",  ".jpeg", ".pgm", ".ppm",
                                                                     ".bmp", ".tiff", ".tif",  ".webp"};
/// Folder of pictures in natural order of their names (2 before 10). If it holds `frames.csv` with columns
/// `file,utime_us`, that is the order and the times; otherwise pictures are frame_rate_hz apart, from utime 0.
std::unique_ptr<FrameSource> open_images(const std::string& directory, double frame_rate_hz);

}  // namespace pilotfish::capture
PILOTFISH_API_END
