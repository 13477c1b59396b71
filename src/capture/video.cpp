#include <cmath>
#include <filesystem>
#include <opencv2/videoio.hpp>
#include <sstream>

#include "gray_frame.hpp"
#include "pilotfish/capture/frame_source.hpp"

namespace pilotfish::capture {
namespace {

class Video : public FrameSource {
 public:
  Video(const cv::VideoCapture& capture, std::string description)
      : capture_(capture), description_(std::move(description)) {}

  std::optional<Frame> next() override {
    try {
      ended_ = !capture_.grab();
      if (ended_) return std::nullopt;
      const auto utime = std::llround(capture_.get(cv::CAP_PROP_POS_MSEC) * 1e3);
      cv::Mat picture;  // a new one each time: the frame keeps it
      if (!capture_.retrieve(picture)) picture.release();
      return gray_frame(picture, utime);
    } catch (const cv::Exception&) {
      ended_ = true;
      return std::nullopt;
    }
  }

  std::string why_ended() const override { return ended_ ? "the end of the video" : ""; }
  bool live() const override { return false; }
  std::string describe() const override { return description_; }

 private:
  cv::VideoCapture capture_;
  std::string description_;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> open_video(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw CaptureError("there is no video file " + path);
  cv::VideoCapture capture;
  try {
    capture.open(path, cv::CAP_FFMPEG);  // not GStreamer, nor OpenCV's guess that it is one of many pictures
  } catch (const cv::Exception&) {       // handled like any other refusal below
  }
  if (!capture.isOpened())
    throw CaptureError("cannot decode the video " + path + ": FFmpeg knows neither its container nor its codec");
  capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);  // the raster as the sensor gave it, as with pictures
  std::ostringstream description;
  description << "video " << path << " (" << capture.get(cv::CAP_PROP_FRAME_WIDTH) << "x"
              << capture.get(cv::CAP_PROP_FRAME_HEIGHT) << ", " << capture.get(cv::CAP_PROP_FPS) << " Hz)";
  return std::make_unique<Video>(capture, description.str());
}

}  // namespace pilotfish::capture
