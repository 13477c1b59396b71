#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <opencv2/videoio.hpp>
#include <sstream>

#include "gray_frame.hpp"
#include "picture_list.hpp"
#include "pilotfish/capture/frame_source.hpp"

namespace pilotfish::capture {
namespace {

std::int64_t now_us() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

class Camera : public FrameSource {
 public:
  Camera(const cv::VideoCapture& capture, std::string description)
      : capture_(capture), description_(std::move(description)) {}

  std::optional<Frame> next() override {
    try {
      if (!capture_.grab()) return std::nullopt;
      const std::int64_t utime = now_us();  // before the decoding, which takes milliseconds
      cv::Mat picture;
      if (!capture_.retrieve(picture)) picture.release();
      return gray_frame(picture, utime);
    } catch (const cv::Exception&) {
      return std::nullopt;
    }
  }

  bool live() const override { return true; }
  std::string describe() const override { return description_; }

 private:
  cv::VideoCapture capture_;
  std::string description_;
};

/// "/dev/video0 /dev/video2", or "none".
std::string cameras_present() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error))
    if (entry.path().filename().string().rfind("video", 0) == 0) names.push_back(entry.path().string());
  std::sort(names.begin(), names.end(), natural_less);
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text.empty() ? "none" : text;
}

}  // namespace

std::unique_ptr<FrameSource> open_camera(int index, int width, int height, double frame_rate_hz) {
  const std::string device = "/dev/video" + std::to_string(index);
  const std::string present = "; cameras here: " + cameras_present();
  if (!std::filesystem::exists(device)) throw CaptureError("there is no camera " + device + present);
  if (::access(device.c_str(), R_OK | W_OK) != 0)
    throw CaptureError("cannot use the camera " + device + ": " + std::strerror(errno) +
                       "; add yourself to the group 'video' (sudo usermod -aG video $USER) and log in again" + present);
  cv::VideoCapture capture;
  try {
    capture.open(index, cv::CAP_V4L2);
  } catch (const cv::Exception&) {  // handled like any other refusal below
  }
  if (!capture.isOpened())
    throw CaptureError("the camera " + device + " cannot be opened: another program may be using it, or it gives no " +
                       "pictures (many cameras have a second device for metadata)" + present);
  capture.set(cv::CAP_PROP_FRAME_WIDTH, width);
  capture.set(cv::CAP_PROP_FRAME_HEIGHT, height);
  capture.set(cv::CAP_PROP_FPS, frame_rate_hz);
  capture.set(cv::CAP_PROP_BUFFERSIZE, 1);  // old pictures are of no use to anyone
  const int real_width = static_cast<int>(capture.get(cv::CAP_PROP_FRAME_WIDTH));
  const int real_height = static_cast<int>(capture.get(cv::CAP_PROP_FRAME_HEIGHT));
  if (real_width != width || real_height != height)
    throw CaptureError("the camera " + device + " gives " + std::to_string(real_width) + "x" +
                       std::to_string(real_height) + ", the calibration is for " + std::to_string(width) + "x" +
                       std::to_string(height) + "; see v4l2-ctl --device " + device + " --list-formats-ext");
  std::ostringstream description;
  description << "camera " << device << " (" << width << "x" << height << ", " << capture.get(cv::CAP_PROP_FPS)
              << " Hz)";
  return std::make_unique<Camera>(capture, description.str());
}

}  // namespace pilotfish::capture
