#include "gray_frame.hpp"

#include <opencv2/imgproc.hpp>

namespace pilotfish::capture {

Frame gray_frame(const cv::Mat& picture, std::int64_t utime) noexcept {
  const auto without_pixels = [utime] { return Frame{utime, {}, nullptr}; };
  try {
    auto gray = std::make_shared<cv::Mat>(picture);
    if (gray->empty() || gray->dims != 2) return without_pixels();
    if (gray->depth() == CV_16U) gray->convertTo(*gray, CV_8U, 1.0 / 257.0);
    if (gray->depth() != CV_8U) return without_pixels();
    switch (gray->channels()) {
      case 1: break;
      case 3: cv::cvtColor(*gray, *gray, cv::COLOR_BGR2GRAY); break;
      case 4: cv::cvtColor(*gray, *gray, cv::COLOR_BGRA2GRAY); break;
      default: return without_pixels();
    }
    const std::size_t stride_bytes = gray->step[0];
    const ImageView view{gray->data, stride_bytes * static_cast<std::size_t>(gray->rows - 1) + gray->cols, gray->cols,
                         gray->rows, static_cast<int>(stride_bytes)};
    return {utime, view, gray};
  } catch (const std::exception&) {  // out of memory, or OpenCV's own
    return without_pixels();
  }
}

}  // namespace pilotfish::capture
