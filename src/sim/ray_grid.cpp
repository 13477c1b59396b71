#include "ray_grid.hpp"

#include <algorithm>

namespace pilotfish::sim {

RayGrid::RayGrid(const CameraModel& camera) : columns(camera.width + 1), rows(camera.height + 1) {
  x.reserve(static_cast<std::size_t>(columns) * rows);
  y.reserve(x.capacity());
  for (int v = 0; v < rows; ++v)
    for (int u = 0; u < columns; ++u) {
      const Eigen::Vector2d ray = normalize_pixel(camera, {u - 0.5, v - 0.5});
      x.push_back(static_cast<float>(ray.x()));
      y.push_back(static_cast<float>(ray.y()));
    }
  const auto [least_x, greatest_x] = std::minmax_element(x.begin(), x.end());
  const auto [least_y, greatest_y] = std::minmax_element(y.begin(), y.end());
  min_x = *least_x;
  max_x = *greatest_x;
  min_y = *least_y;
  max_y = *greatest_y;
}

}  // namespace pilotfish::sim
