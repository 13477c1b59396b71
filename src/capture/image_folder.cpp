#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string_view>

#include "gray_frame.hpp"
#include "picture_list.hpp"
#include "pilotfish/capture/frame_source.hpp"
#include "pilotfish/core/read_file.hpp"
#include "pilotfish/jpeg/jpeg.hpp"

namespace pilotfish::capture {
namespace {

/// A raw picture of the largest size in 16-bit colour would be larger, but none is expected; a photograph is some MB.
constexpr std::size_t kMaxPictureBytes = std::size_t{256} << 20;
constexpr std::string_view kJpegStart = "\xff\xd8\xff";

/// By its content, whatever its name. A JPEG goes through our own strict decoder: OpenCV fills missing parts of a
/// truncated one with gray and reports nothing. (Its decoders for the other formats refuse truncated files; a test
/// checks each.)
Frame read(const std::filesystem::path& path, std::int64_t utime) {
  Frame without_pixels{utime, {}, nullptr};
  const FileRead file = read_file(path, kMaxPictureBytes);
  if (!file.bytes || file.bytes->empty()) return without_pixels;
  if (file.bytes->compare(0, kJpegStart.size(), kJpegStart) == 0) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(file.bytes->data());
    const std::optional<jpeg::Size> size = jpeg::claimed_size(data, file.bytes->size());
    auto pixels = size ? jpeg::decode(data, file.bytes->size(), *size) : std::nullopt;
    return pixels ? Frame::from_pixels(utime, size->width, size->height, std::move(*pixels)) : without_pixels;
  }
  try {
    // The raster as the sensor gave it: a calibration does not depend on the orientation tag.
    const cv::Mat bytes(1, static_cast<int>(file.bytes->size()), CV_8U, const_cast<char*>(file.bytes->data()));
    return gray_frame(cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION), utime);
  } catch (const cv::Exception&) {  // a size beyond OpenCV's limit
    return without_pixels;
  }
}

class ImageFolder : public FrameSource {
 public:
  ImageFolder(std::vector<ListedPicture> pictures, std::string description)
      : pictures_(std::move(pictures)), description_(std::move(description)) {}

  std::optional<Frame> next() override {
    if (next_ == pictures_.size()) return std::nullopt;
    const ListedPicture& picture = pictures_[next_++];
    return read(picture.path, picture.utime);
  }

  std::string why_ended() const override { return next_ == pictures_.size() ? "no more pictures" : ""; }
  bool live() const override { return false; }
  std::string describe() const override { return description_; }

 private:
  std::vector<ListedPicture> pictures_;
  std::string description_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> open_images(const std::string& directory, double frame_rate_hz) {
  std::vector<ListedPicture> pictures = list_pictures(directory, frame_rate_hz);
  std::ostringstream description;
  description << "images in " << directory << " (" << pictures.size() << " pictures, ";
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::path(directory) / "frames.csv", error)) {
    description << "times from frames.csv)";
  } else {
    description << frame_rate_hz << " Hz)";
  }
  return std::make_unique<ImageFolder>(std::move(pictures), description.str());
}

}  // namespace pilotfish::capture
