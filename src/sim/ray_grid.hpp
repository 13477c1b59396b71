#pragma once

#include <vector>

#include "pilotfish/core/camera_model.hpp"

namespace pilotfish::sim {

/// The undistorted rays (x, y, 1) through the corners of all pixels: (width + 1) x (height + 1) of them, row
/// by row. The corner (u, v) lies half a pixel up and left of the centre of pixel (u, v).
struct RayGrid {
  explicit RayGrid(const CameraModel& camera);
  int columns = 0, rows = 0;
  std::vector<float> x, y;
  double min_x = 0.0, max_x = 0.0, min_y = 0.0, max_y = 0.0;
  double largest_step = 0.0;  ///< between two corners of one pixel, in x or in y
};

}  // namespace pilotfish::sim
