#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "pilotfish/core/frame.hpp"

namespace pilotfish::capture {

/// An OpenCV picture as a gray frame that keeps its pixels alive: BGR and BGRA become luma, 16 bits their
/// upper 8 (scaled by 1/257). Anything else, or nothing, becomes a frame without pixels. Never throws.
Frame gray_frame(const cv::Mat& picture, std::int64_t utime) noexcept;

}  // namespace pilotfish::capture
