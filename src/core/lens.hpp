#pragma once

#include "pilotfish/core/camera_model.hpp"

namespace pilotfish {

/// The formulas in camera_model.hpp, on the plane Z = 1: (x, y) to (x', y').
Eigen::Vector2d distort(const CameraModel& camera, const Eigen::Vector2d& point);
/// d distort / d (x, y).
Eigen::Matrix2d distort_jacobian(const CameraModel& camera, const Eigen::Vector2d& point);
/// (x', y') to (x, y).
Eigen::Vector2d undistort(const CameraModel& camera, const Eigen::Vector2d& distorted);

}  // namespace pilotfish
