#include "lens.hpp"

#include <algorithm>
#include <cmath>

namespace pilotfish {
namespace {

Eigen::Vector2d distort_brown_conrady(const CameraModel& c, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  return {x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x),
          y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y};
}

/// d distort / d (x, y), by differentiating the model in the header term by term.
Eigen::Matrix2d jacobian_brown_conrady(const CameraModel& c, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double slope = 2.0 * (c.k1 + r2 * (2.0 * c.k2 + 3.0 * r2 * c.k3));  // d radial / d x = slope * x
  const double cross = slope * x * y + 2.0 * (c.p1 * x + c.p2 * y);
  Eigen::Matrix2d jacobian;
  jacobian << radial + slope * x * x + 2.0 * c.p1 * y + 6.0 * c.p2 * x, cross,  //
      cross, radial + slope * y * y + 6.0 * c.p1 * y + 2.0 * c.p2 * x;
  return jacobian;
}

/// Newton's method, from the point itself.
Eigen::Vector2d undistort_brown_conrady(const CameraModel& camera, const Eigen::Vector2d& target) {
  Eigen::Vector2d point = target;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Eigen::Vector2d residual = distort_brown_conrady(camera, point) - target;
    const Eigen::Vector2d correction = jacobian_brown_conrady(camera, point).inverse() * residual;
    if (!correction.allFinite()) break;
    point -= correction;
    if (correction.squaredNorm() < 1e-26) break;
  }
  return point;
}

// Kannala-Brandt. With td(t) the header's polynomial and scale = td / r:
//
//   d (x', y') / d (x, y) = scale I + (d td / d r - scale) p p^T / r^2,    d td / d r = (d td / d t) / (1 + r^2)
//
// because scale depends on r alone and d r / d p = p^T / r. Near the axis, where r vanishes, t = r - r^3 / 3 gives
// scale = 1 + (k1 - 1/3) r^2 and (d td / d r - scale) / r^2 = 2 (k1 - 1/3), both up to r^2 times less.

constexpr double kOnAxis = 1e-6;                 ///< of r: what is left out is of the order of its square
constexpr double kSteepest_rad = radians(89.9);  ///< beyond, the plane Z = 1 has no place for a direction

double bent_angle(const CameraModel& c, double t) {
  const double t2 = t * t;
  return t * (1.0 + t2 * (c.k1 + t2 * (c.k2 + t2 * (c.k3 + t2 * c.k4))));
}

double bent_angle_slope(const CameraModel& c, double t) {
  const double t2 = t * t;
  return 1.0 + t2 * (3.0 * c.k1 + t2 * (5.0 * c.k2 + t2 * (7.0 * c.k3 + t2 * 9.0 * c.k4)));
}

Eigen::Vector2d distort_kannala_brandt(const CameraModel& c, const Eigen::Vector2d& p) {
  const double r = p.norm();
  if (r < kOnAxis) return p;
  return p * (bent_angle(c, std::atan(r)) / r);
}

Eigen::Matrix2d jacobian_kannala_brandt(const CameraModel& c, const Eigen::Vector2d& p) {
  const double r = p.norm();
  if (r < kOnAxis) return Eigen::Matrix2d::Identity();
  const double t = std::atan(r), scale = bent_angle(c, t) / r, slope = bent_angle_slope(c, t) / (1.0 + r * r);
  return scale * Eigen::Matrix2d::Identity() + ((slope - scale) / (r * r)) * p * p.transpose();
}

/// Newton's method on the angle alone, kept in front of the camera.
Eigen::Vector2d undistort_kannala_brandt(const CameraModel& c, const Eigen::Vector2d& target) {
  const double td = target.norm();
  if (td < kOnAxis) return target;
  double t = std::min(td, kSteepest_rad);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const double slope = bent_angle_slope(c, t);
    const double next = std::clamp(t - (bent_angle(c, t) - td) / slope, 0.0, kSteepest_rad);
    if (!std::isfinite(next)) break;
    const bool done = std::abs(next - t) < 1e-14;
    t = next;
    if (done) break;
  }
  return target * (std::tan(t) / td);
}

}  // namespace

Eigen::Vector2d distort(const CameraModel& camera, const Eigen::Vector2d& point) {
  return camera.lens == Lens::kannala_brandt ? distort_kannala_brandt(camera, point)
                                             : distort_brown_conrady(camera, point);
}

Eigen::Matrix2d distort_jacobian(const CameraModel& camera, const Eigen::Vector2d& point) {
  return camera.lens == Lens::kannala_brandt ? jacobian_kannala_brandt(camera, point)
                                             : jacobian_brown_conrady(camera, point);
}

Eigen::Vector2d undistort(const CameraModel& camera, const Eigen::Vector2d& distorted) {
  if (!camera.has_distortion()) return distorted;
  return camera.lens == Lens::kannala_brandt ? undistort_kannala_brandt(camera, distorted)
                                             : undistort_brown_conrady(camera, distorted);
}

}  // namespace pilotfish
