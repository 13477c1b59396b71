#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "pilotfish/core/frame.hpp"

namespace pilotfish::capture {

/// A source that cannot be opened. The message says what was tried and what to do about it.
class CaptureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Pictures, one after the other. next() blocks until there is one, so a live source belongs on a thread of its own.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next frame; nothing at the end (or when a camera has gone). A picture that cannot be decoded comes
  /// as a frame without pixels (0 x 0), so that it is counted and refused downstream instead of vanishing.
  virtual std::optional<Frame> next() = 0;
  /// Frames come whether or not anyone asks for them: use the newest. Otherwise every frame matters.
  virtual bool live() const = 0;
  /// One line for the log, e.g. "images in data/run1 (300 pictures, 30 Hz)".
  virtual std::string describe() const = 0;
};

/// V4L or other camera by number, asked for the calibration's size; frames carry the time at which they were read.
std::unique_ptr<FrameSource> open_camera(int index, int width, int height, double frame_rate_hz);
/// Video file; frames carry the file's own timestamps.
std::unique_ptr<FrameSource> open_video(const std::string& path);
/// Folder of pictures in natural order of their names (2 before 10). If it holds `frames.csv` with columns
/// `file,utime_us`, that is the order and the times; otherwise pictures are frame_rate_hz apart, from utime 0.
std::unique_ptr<FrameSource> open_images(const std::string& directory, double frame_rate_hz);

}  // namespace pilotfish::capture
