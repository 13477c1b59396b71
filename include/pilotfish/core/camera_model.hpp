#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// How a lens bends directions.
enum class Lens {
  brown_conrady,  ///< OpenCV's calibrateCamera, ROS's plumb_bob: k1, k2, p1, p2, k3
  kannala_brandt  ///< a fisheye; OpenCV's fisheye module, ROS's equidistant: k1, k2, k3, k4
};

/// A camera as OpenCV models it, with one of two lenses. Points are in front of it (Z > 0): of a fisheye's picture that
/// is what lies less than 90 degrees off its axis.
///
/// Brown-Conrady (k1, k2, p1, p2, k3); ViSP's "perspectiveProjWithDistortion" is the special case k1 = kud, all others
/// zero:
///
///   x = X/Z, y = Y/Z, r2 = x^2 + y^2, radial = 1 + k1 r2 + k2 r2^2 + k3 r2^3
///   x' = x radial + 2 p1 x y + p2 (r2 + 2 x^2),  y' = y radial + p1 (r2 + 2 y^2) + 2 p2 x y
///
/// Kannala-Brandt (k1, k2, k3, k4; IEEE PAMI 28(8), 2006): with r = sqrt(r2) and the angle to the axis t = atan(r),
///
///   td = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8),  x' = x td / r,  y' = y td / r
///
/// Then u = fx x' + cx,  v = fy y' + cy         with (0, 0) the centre of the top-left pixel
struct CameraModel {
  int width = 0;   ///< [px], of the images that were calibrated
  int height = 0;  ///< [px]
  /// Focal lengths and principal point [px].
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  /// Distortion, as above.
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;
  double k4 = 0.0;                  ///< of a Kannala-Brandt lens alone, which has no p1 and p2
  Lens lens = Lens::brown_conrady;  ///< which of the two
  /// From the exposure of the first row to that of the last [s]: rolling shutter. 0: all rows at once.
  double readout_s = 0.0;
  static constexpr double kMaxReadout_s = 0.1;  ///< [s]

  /// False for a pure pinhole.
  bool has_distortion() const {
    return lens == Lens::kannala_brandt || k1 != 0.0 || k2 != 0.0 || p1 != 0.0 || p2 != 0.0 || k3 != 0.0;
  }
  /// Throws ConfigError ("camera.fx: ...") on invalid sizes or intrinsics.
  void validate() const;
};

/// Normalised image-plane point (x, y) at Z = 1, undistorted, to pixels.
Eigen::Vector2d project_normalized(const CameraModel& camera, const Eigen::Vector2d& normalized);
/// Its derivative there: (du, dv) per (dx, dy).
Eigen::Matrix2d pixels_from_normalized(const CameraModel& camera, const Eigen::Vector2d& normalized);
/// Point in the camera frame [m] to pixels; nothing if it is not in front of the camera (Z <= 0).
std::optional<Eigen::Vector2d> project(const CameraModel& camera, const Eigen::Vector3d& point_c);
/// Pixels to the undistorted normalised image plane, by Newton's method on the distortion polynomial (error below 1e-10
/// wherever the model is invertible). Pixels of a fisheye at 90 degrees and more off its axis come out far outside, at
/// 89.9.
Eigen::Vector2d normalize_pixel(const CameraModel& camera, const Eigen::Vector2d& pixel);

/// Where the camera sits on the robot. With all angles zero it looks along the base's x axis.
struct CameraMounting {
  PILOTFISH_PARAMETERS(CameraMounting);
  PILOTFISH_PARAMETER(Vector3, position_m, {}, -5.0, 5.0, "optical centre in the base frame: forward, left, up");
  PILOTFISH_PARAMETER(double, pan_rad, 0.0, -kPi, kPi, "positive: the camera looks to the left");
  PILOTFISH_PARAMETER(double, tilt_rad, 0.0, -kPi / 2, kPi / 2, "positive: the camera looks up");
  PILOTFISH_PARAMETER(double, roll_rad, 0.0, -kPi, kPi, "positive: turned clockwise, seen from behind the camera");
};

/// bMc: camera frame (x right, y down, z forward) to base frame (x forward, y left, z up).
Eigen::Isometry3d base_from_camera(const CameraMounting& mounting);

}  // namespace pilotfish
PILOTFISH_API_END
