#include "ray_grid.hpp"

#include <algorithm>
#include <cmath>

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
  for (int v = 0; v + 1 < rows; ++v)
    for (int u = 0; u + 1 < columns; ++u) {
      const std::size_t here = static_cast<std::size_t>(v) * columns + u;
      for (const std::size_t other : {here + 1, here + columns, here + columns + 1})
        largest_step = std::max(
            largest_step, static_cast<double>(std::max(std::abs(x[other] - x[here]), std::abs(y[other] - y[here]))));
    }
  const auto [least_x, greatest_x] = std::minmax_element(x.begin(), x.end());
  const auto [least_y, greatest_y] = std::minmax_element(y.begin(), y.end());
  min_x = *least_x;
  max_x = *greatest_x;
  min_y = *least_y;
  max_y = *greatest_y;
}

}  // namespace pilotfish::sim
