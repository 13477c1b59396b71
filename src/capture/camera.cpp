#include <linux/videodev2.h>

#include <sstream>
#include <utility>

#include "buffer_age.hpp"
#include "luma.hpp"
#include "pilotfish/capture/frame_source.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "v4l2_format.hpp"
#include "v4l2_stream.hpp"

namespace pilotfish::capture {
namespace {

/// A camera that has been silent for so long is closed, for its driver often recovers only if it is opened anew. The
/// first picture may take longer: sensors start slowly.
constexpr std::int64_t kSilenceUs = 2'000'000;
constexpr std::int64_t kFirstSilenceUs = 5'000'000;

class Camera : public FrameSource {
 public:
  Camera(V4l2Device device, const GrantedFormat& format)
      : format_(format), stream_(std::move(device)), silent_from_us_(monotonic_now().us) {}

  std::optional<Frame> next() override {
    if (ended()) return std::nullopt;
    const std::optional<FilledBuffer> filled = stream_.newest(kPatience);
    if (!filled) {
      if (monotonic_now().us - silent_from_us_ > silence_allowed_us_)
        silent_ = "the camera " + stream_.device().path() + " has given no picture for " +
                  std::to_string(silence_allowed_us_ / 1'000'000) + " s";
      return std::nullopt;
    }
    Frame frame = frame_of(*filled);
    stream_.give_back(*filled);
    silent_from_us_ = monotonic_now().us;
    silence_allowed_us_ = kSilenceUs;
    return frame;
  }

  std::string why_ended() const override { return silent_.empty() ? stream_.why_ended() : silent_; }
  bool live() const override { return true; }

  std::string describe() const override {
    std::ostringstream text;
    text << "camera " << stream_.device().path() << " (" << format_.layout.width << "x" << format_.layout.height << " "
         << name_of(format_.layout.fourcc) << ", ";
    if (format_.frame_rate_hz > 0.0)
      text << format_.frame_rate_hz << " Hz";
    else
      text << "rate unknown";
    text << ", stamps " << stream_.stamped() << ")";
    return text.str();
  }

 private:
  Frame frame_of(const FilledBuffer& filled) {
    std::optional<std::vector<std::uint8_t>> pixels;
    if (filled.size_bytes > 0) pixels = decode(filled);
    // After the decoding, which takes milliseconds: the age is that at arrival.
    const ClockReading now = read_clocks();
    suspension_ = look_for_suspension(suspension_, now);
    const std::int64_t age_us = buffer_age_us(filled.buffer, filled.queue_seen_empty_at_us, now, suspension_);
    Frame frame;
    if (pixels) frame = Frame::from_pixels(0, format_.layout.width, format_.layout.height, std::move(*pixels));
    frame.utime = now.wall_us - age_us;
    frame.known_age_us = age_us;
    return frame;
  }

  std::optional<std::vector<std::uint8_t>> decode(const FilledBuffer& filled) const noexcept {
    try {
      return luma(filled.data, filled.size_bytes, format_.layout);
    } catch (const std::exception&) {  // out of memory
      return std::nullopt;
    }
  }

  GrantedFormat format_;
  V4l2Stream stream_;
  Suspension suspension_ = look_for_suspension({}, read_clocks());
  std::string silent_;
  std::int64_t silent_from_us_;
  std::int64_t silence_allowed_us_ = kFirstSilenceUs;
};

}  // namespace

std::unique_ptr<FrameSource> open_camera(int index, int width, int height, double frame_rate_hz) {
  V4l2Device device(index);
  const GrantedFormat format = negotiate(device, width, height, frame_rate_hz);
  return std::make_unique<Camera>(std::move(device), format);
}

}  // namespace pilotfish::capture
