#pragma once

#include <visp3/core/vpCameraParameters.h>
#include <visp3/core/vpHomogeneousMatrix.h>
#include <visp3/core/vpImage.h>

#include <Eigen/Geometry>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/frame.hpp"

PILOTFISH_API_BEGIN
/// Between ViSP's types and Pilotfish's. Lengths are metres and image coordinates pixels on both sides, and on both
/// sides the centre of the picture's first pixel is at (0, 0): nothing is scaled or shifted.
namespace pilotfish::visp {

/// The picture without a copy: `image` must outlive the frame and not change meanwhile. utime: exposure [us].
Frame frame_of(const vpImage<unsigned char>& image, std::int64_t utime);
/// The frame's pixels, copied. An empty picture if check(frame.image) does not hold.
vpImage<unsigned char> image_of(const Frame& frame);

/// px, py, u0, v0 and, of a camera with distortion, k_ud as k1 (both multiply the normalised coordinates by
/// 1 + k r^2 on their way to the pixel). width, height [px]: of the pictures, which ViSP's parameters do not contain.
/// Throws ConfigError (camera.*) if that is no usable camera, or for ViSP's Kannala-Brandt model.
CameraModel camera_model_of(const vpCameraParameters& camera, int width, int height);
/// Throws ConfigError, key camera.distortion, if the lens has more than k1: ViSP has no room for it.
vpCameraParameters camera_parameters_of(const CameraModel& camera);

/// The same rigid motion; cMo in ViSP is cMo in Pilotfish: camera x right, y down, z ahead.
Eigen::Isometry3d isometry_of(const vpHomogeneousMatrix& motion);
/// The same motion as ViSP's.
vpHomogeneousMatrix homogeneous_of(const Eigen::Isometry3d& motion);

}  // namespace pilotfish::visp
PILOTFISH_API_END
