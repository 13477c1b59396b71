#include "v4l2_format.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "pilotfish/capture/frame_source.hpp"

namespace pilotfish::capture {
namespace {

/// A camera that offers 29.97 Hz where 30 are requested is fast enough.
constexpr double kFastEnough = 0.95;

v4l2_format format_request(std::uint32_t fourcc, int width, int height) {
  v4l2_format request{};
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.fmt.pix.pixelformat = fourcc;
  request.fmt.pix.width = static_cast<std::uint32_t>(width);
  request.fmt.pix.height = static_cast<std::uint32_t>(height);
  request.fmt.pix.field = V4L2_FIELD_NONE;
  return request;
}

bool is_granted(const v4l2_format& answer, std::uint32_t fourcc, int width, int height) {
  const v4l2_pix_format& pix = answer.fmt.pix;
  // Interlaced pictures are two exposures in one: of no use for measuring what moves.
  return pix.pixelformat == fourcc && pix.width == static_cast<std::uint32_t>(width) &&
         pix.height == static_cast<std::uint32_t>(height) &&
         (pix.field == V4L2_FIELD_NONE || pix.field == V4L2_FIELD_ANY);
}

double rate_hz(const v4l2_fract& interval) {
  return interval.numerator == 0 ? 0.0 : static_cast<double>(interval.denominator) / interval.numerator;
}

/// The highest rate of a format at a size; without limit where the driver does not list rates.
double highest_rate_hz(const V4l2Device& device, std::uint32_t fourcc, int width, int height) {
  double highest = 0.0;
  v4l2_frmivalenum interval{};
  interval.pixel_format = fourcc;
  interval.width = static_cast<std::uint32_t>(width);
  interval.height = static_cast<std::uint32_t>(height);
  for (; interval.index < 256 && device.ask(VIDIOC_ENUM_FRAMEINTERVALS, &interval); ++interval.index) {
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) return rate_hz(interval.stepwise.min);
    highest = std::max(highest, rate_hz(interval.discrete));
  }
  return highest > 0.0 ? highest : std::numeric_limits<double>::infinity();
}

/// "YUYV 640x480, MJPG 1280x720": what the driver offers for the request in each of its formats.
std::string what_it_offers(const V4l2Device& device, int width, int height) {
  std::string text;
  v4l2_fmtdesc description{};
  description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; description.index < 64 && device.ask(VIDIOC_ENUM_FMT, &description); ++description.index) {
    v4l2_format offer = format_request(description.pixelformat, width, height);
    if (!device.ask(VIDIOC_TRY_FMT, &offer)) continue;
    std::string name(4, ' ');
    std::memcpy(name.data(), &description.pixelformat, 4);
    for (char& c : name) c = c >= ' ' && c <= '~' ? c : '?';
    text += (text.empty() ? "" : ", ") + name + " " + std::to_string(offer.fmt.pix.width) + "x" +
            std::to_string(offer.fmt.pix.height);
  }
  return text.empty() ? "nothing" : text;
}

std::optional<std::uint32_t> best_format(const V4l2Device& device, int width, int height, double frame_rate_hz) {
  std::optional<std::uint32_t> best;
  double best_rate_hz = 0.0;
  for (const std::uint32_t fourcc : readable_formats()) {
    v4l2_format offer = format_request(fourcc, width, height);
    if (!device.ask(VIDIOC_TRY_FMT, &offer) || !is_granted(offer, fourcc, width, height)) continue;
    const double rate = highest_rate_hz(device, fourcc, width, height);
    if (rate >= kFastEnough * frame_rate_hz) return fourcc;
    if (rate > best_rate_hz) {
      best = fourcc;
      best_rate_hz = rate;
    }
  }
  return best;
}

/// Requests the rate; returns what the driver granted, 0 if unknown, which is no reason to refuse a camera.
double set_rate(const V4l2Device& device, double frame_rate_hz) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  parameters.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::llround(1000.0 * frame_rate_hz))};
  if (!device.ask(VIDIOC_S_PARM, &parameters)) return 0.0;
  return rate_hz(parameters.parm.capture.timeperframe);
}

}  // namespace

GrantedFormat negotiate(const V4l2Device& device, int width, int height, double frame_rate_hz) {
  const std::optional<std::uint32_t> fourcc = best_format(device, width, height, frame_rate_hz);
  if (!fourcc)
    throw CaptureError("the camera " + device.path() + " gives " + what_it_offers(device, width, height) +
                       ", the calibration is for " + std::to_string(width) + "x" + std::to_string(height) +
                       "; see v4l2-ctl --device " + device.path() + " --list-formats-ext");
  v4l2_format answer = format_request(*fourcc, width, height);
  if (!device.ask(VIDIOC_S_FMT, &answer)) {
    if (errno == EBUSY) throw CaptureError("the camera " + device.path() + " is in use by another program");
    throw CaptureError("the camera " + device.path() + " refuses its own format: " + std::strerror(errno));
  }
  const v4l2_pix_format& pix = answer.fmt.pix;
  if (!is_granted(answer, *fourcc, width, height))
    throw CaptureError("the camera " + device.path() + " gives " + std::to_string(pix.width) + "x" +
                       std::to_string(pix.height) + " after it had promised " + std::to_string(width) + "x" +
                       std::to_string(height));
  return {{*fourcc, width, height, static_cast<int>(pix.bytesperline)}, set_rate(device, frame_rate_hz)};
}

}  // namespace pilotfish::capture
