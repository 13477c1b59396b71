#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "convex_polygon.hpp"
#include "pilotfish/sim/renderer.hpp"
#include "ray_grid.hpp"

namespace pilotfish::sim {

/// A surface in front of the camera. Along the ray (x, y, 1): (a', b', w)^T = from_ray (x, y, 1)^T, with a' /
/// w and b' / w in [-1, 1] inside the rectangle and w = 1 / depth.
struct Facet {
  Eigen::Matrix3d from_ray;
  double priority = 1.0;  ///< depths are compared as w * priority: a sheet wins over the wall it hangs on
  int cells = 1;
  const float* grays = nullptr;
  int left = 0, right = 0, top = 0, bottom = 0;  ///< pixels it may touch: [left, right) x [top, bottom)
  std::array<Line2, 4> sides{};                  ///< inside is positive

  Line2 row(int i) const { return {from_ray(i, 0), from_ray(i, 1), from_ray(i, 2)}; }
  /// Where along axis (0: a, 1: b) equals t: positive on the side of larger values.
  Line2 line(int axis, double t) const {
    const Line2 s = row(axis), w = row(2);
    return {s.a - t * w.a, s.b - t * w.b, s.c - t * w.c};
  }
};

/// Those of all surfaces of all bodies that are in the picture and not hidden behind a nearer body. Every pixel that
/// one of their outlines runs through is marked in `crossed`.
std::vector<Facet> facets_of(const CameraModel& camera, const RayGrid& grid, const std::vector<VisibleBody>& bodies,
                             std::vector<std::uint8_t>& crossed);

}  // namespace pilotfish::sim
