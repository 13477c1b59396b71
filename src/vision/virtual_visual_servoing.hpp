#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace pilotfish::vision {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A point of the body and where it was seen.
struct PointSighting {
  Eigen::Vector3d point_o;                 ///< [m], in the body's frame
  Eigen::Vector2d pixel;                   ///< in the picture as it is
  Eigen::Vector2d normalized;              ///< the same, undistorted, on the plane Z = 1
  Eigen::Matrix2d pixels_from_normalized;  ///< derivative of the pixel by the normalised point, at that point
};

/// The bottom of one valley of the squared error.
struct LocalMinimum {
  Eigen::Isometry3d cMo;
  Matrix6d information;  ///< sum of J^T J in pixels: the inverse covariance of the twist for corners with
                         ///< unit noise
};

/// Moves a virtual camera from `start` until the points are where they were seen. Nothing if it does not come
/// to rest with all points in front of it.
std::optional<LocalMinimum> servo_virtually(const Eigen::Isometry3d& start, const std::vector<PointSighting>& points);

}  // namespace pilotfish::vision
