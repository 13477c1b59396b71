#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/se3.hpp"

namespace pilotfish::vision {

/// One tag of the body and where its corners were seen.
struct SquareSighting {
  std::array<Eigen::Vector3d, 4> corners_o;   ///< [m], in the body's frame
  std::array<Eigen::Vector2d, 4> normalized;  ///< as seen, undistorted, on the plane Z = 1
  /// Takes the eight differences on that plane to eight numbers with independent unit noise: L^-1 W, with L L^T the
  /// covariance of the corners in pixels and W the derivative of pixels by normalised points.
  Eigen::Matrix<double, 8, 8> whitening;
};
using SquareSightings = BoundedVector<SquareSighting, kMaxTagsOnBody>;

/// A local minimum of the squared error.
struct LocalMinimum {
  Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();
  Matrix6d information = Matrix6d::Zero();  ///< J^T J: the inverse covariance of the twist
  double squared_error = 0.0;               ///< whitened: chi-squared with 8 tags - 6 degrees of freedom
};

/// Moves a virtual camera from `start` until the corners are where they were measured. Nothing if it does not converge
/// with all corners in front of it. Never allocates.
std::optional<LocalMinimum> servo_virtually(const Eigen::Isometry3d& start, const SquareSightings& squares);

}  // namespace pilotfish::vision
