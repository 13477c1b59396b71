#include "pilotfish/vision/homography.hpp"

#include "tag_warp.hpp"

namespace pilotfish::vision {

// The unit square's corners to any quadrilateral, in closed form (Heckbert, "Fundamentals of texture mapping",
// 1989, 2.2.3): with the corners (0,0), (1,0), (1,1), (0,1) at p0 .. p3 and s = p0 - p1 + p2 - p3, d1 = p1 - p2, d2 =
// p3 - p2,
//
//   g = s x d2 / (d1 x d2),   h = d1 x s / (d1 x d2),   columns  (p1 - p0 + g p1, g), (p3 - p0 + h p3, h), (p0, 1).
Eigen::Matrix3d homography_from_corners(const CameraModel& camera,
                                        const std::array<Eigen::Vector2d, 4>& corners_px) noexcept {
  // Our corners are (-1, 1), (1, 1), (1, -1), (-1, -1): p0 = top left.
  const Eigen::Vector2d p0 = normalize_pixel(camera, corners_px[3]), p1 = normalize_pixel(camera, corners_px[2]),
                        p2 = normalize_pixel(camera, corners_px[1]), p3 = normalize_pixel(camera, corners_px[0]);
  const Eigen::Vector2d s = p0 - p1 + p2 - p3, d1 = p1 - p2, d2 = p3 - p2;
  const double g = cross(s, d2) / cross(d1, d2), h = cross(d1, s) / cross(d1, d2);
  Eigen::Matrix3d from_unit, unit_from_tag;
  from_unit.col(0) << p1 - p0 + g * p1, g;
  from_unit.col(1) << p3 - p0 + h * p3, h;
  from_unit.col(2) << p0, 1.0;
  unit_from_tag << 0.5, 0, 0.5, 0, 0.5, 0.5, 0, 0, 1;
  const Eigen::Matrix3d nHt = from_unit * unit_from_tag;
  return nHt / nHt(2, 2);
}

Eigen::Matrix3d homography_from_pose(const Eigen::Isometry3d& cMt, double size_m) noexcept {
  Eigen::Matrix3d nHt;
  nHt << 0.5 * size_m * cMt.linear().col(0), 0.5 * size_m * cMt.linear().col(1), cMt.translation();
  return nHt;
}

}  // namespace pilotfish::vision
