#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "gray_frame.hpp"
#include "picture_list.hpp"
#include "pilotfish/capture/frame_source.hpp"

namespace pilotfish::capture {
namespace {

class ImageFolder : public FrameSource {
 public:
  ImageFolder(std::vector<ListedPicture> pictures, std::string description)
      : pictures_(std::move(pictures)), description_(std::move(description)) {}

  std::optional<Frame> next() override {
    if (next_ == pictures_.size()) return std::nullopt;
    const ListedPicture& picture = pictures_[next_++];
    return gray_frame(read(picture.path.string()), picture.utime);
  }

  std::string why_ended() const override { return next_ == pictures_.size() ? "no more pictures" : ""; }
  bool live() const override { return false; }
  std::string describe() const override { return description_; }

 private:
  static cv::Mat read(const std::string& path) {
    try {
      // The raster as the sensor gave it: a calibration knows nothing of a camera held upright.
      return cv::imread(path, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    } catch (const cv::Exception&) {  // a size beyond OpenCV's limit
      return {};
    }
  }

  std::vector<ListedPicture> pictures_;
  std::string description_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> open_images(const std::string& directory, double frame_rate_hz) {
  std::vector<ListedPicture> pictures = list_pictures(directory, frame_rate_hz);
  std::ostringstream description;
  description << "images in " << directory << " (" << pictures.size() << " pictures, ";
  if (std::filesystem::exists(std::filesystem::path(directory) / "frames.csv")) {
    description << "times from frames.csv)";
  } else {
    description << frame_rate_hz << " Hz)";
  }
  return std::make_unique<ImageFolder>(std::move(pictures), description.str());
}

}  // namespace pilotfish::capture
