#pragma once

#include <Eigen/Geometry>
#include <array>

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// The homography (tag coordinates, see TagPattern, to the undistorted plane Z = 1) that takes the square's corners to
/// these pixels, which come in AprilTag's order; not finite if no square projects to them.
Eigen::Matrix3d homography_from_corners(const CameraModel& camera,
                                        const std::array<Eigen::Vector2d, 4>& corners_px) noexcept;
/// The same of a tag of that size at that pose in the camera.
Eigen::Matrix3d homography_from_pose(const Eigen::Isometry3d& cMt, double size_m) noexcept;

}  // namespace pilotfish::vision
PILOTFISH_API_END
