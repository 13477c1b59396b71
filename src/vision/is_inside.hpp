#pragma once

#include <Eigen/Core>

namespace pilotfish::vision {

/// Of a picture of that size, and at least `margin_px` from its outermost pixels' centres.
inline bool is_inside(const Eigen::Vector2d& pixel, int width, int height, double margin_px = 0.0) {
  return pixel.x() >= margin_px && pixel.y() >= margin_px && pixel.x() <= width - 1.0 - margin_px &&
         pixel.y() <= height - 1.0 - margin_px;
}

}  // namespace pilotfish::vision
