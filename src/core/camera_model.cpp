#include "pilotfish/core/camera_model.hpp"

#include <cmath>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/frame.hpp"

namespace pilotfish {
namespace {

constexpr double kMaxAspect = 1.25;

void require(bool holds, const char* key, double value, const char* allowed) {
  if (holds) return;
  std::ostringstream problem;
  problem << value << " is not allowed; " << allowed;
  throw ConfigError(std::string("camera.") + key, problem.str());
}

Eigen::Vector2d distort(const CameraModel& c, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  return {x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x),
          y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y};
}

/// d distort / d (x, y), by differentiating the model in the header term by term.
Eigen::Matrix2d distort_jacobian(const CameraModel& c, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double slope = 2.0 * (c.k1 + r2 * (2.0 * c.k2 + 3.0 * r2 * c.k3));  // d radial / d x = slope * x
  const double cross = slope * x * y + 2.0 * (c.p1 * x + c.p2 * y);
  Eigen::Matrix2d jacobian;
  jacobian << radial + slope * x * x + 2.0 * c.p1 * y + 6.0 * c.p2 * x, cross,  //
      cross, radial + slope * y * y + 6.0 * c.p1 * y + 2.0 * c.p2 * x;
  return jacobian;
}

/// A lens maps every direction to a pixel of its own, and bends none by more than a fisheye does. A distortion that
/// folds the picture over (a sign lost, or a pattern that was never near the corners) or stretches it beyond that (k1 =
/// 1e9) gives meaningless angles. The outermost tenth of the picture on each side is left out: there, the
/// polynomials of good calibrations are extrapolated.
void check_lens(const CameraModel& camera) {
  if (!camera.has_distortion()) return;
  constexpr double kMargin = 0.1, kMaxError_px = 1.0, kMaxStretch = 5.0;
  for (double u : {kMargin, 1.0 - kMargin})
    for (double v : {kMargin, 1.0 - kMargin}) {
      const Eigen::Vector2d pixel(u * camera.width, v * camera.height);
      const Eigen::Vector2d straight((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
      const Eigen::Vector2d normalized = normalize_pixel(camera, pixel);
      const double error_px = (project_normalized(camera, normalized) - pixel).norm();
      const double stretch = (straight.norm() + 1e-9) / (normalized.norm() + 1e-9);
      // Behind a fold there is another solution: on the other side of the optical axis.
      const bool same_side = straight.dot(normalized) >= 0.0;
      if (error_px < kMaxError_px && same_side && stretch < kMaxStretch && stretch > 1.0 / kMaxStretch) continue;
      std::ostringstream problem;
      problem << "k1 = " << camera.k1 << ", k2 = " << camera.k2 << ", p1 = " << camera.p1 << ", p2 = " << camera.p2
              << ", k3 = " << camera.k3 << " is no lens: allowed is what leads every direction to a pixel of its own, "
              << "at " << 1.0 / kMaxStretch << " to " << kMaxStretch << " times the radius without distortion; pixel ("
              << pixel.x() << ", " << pixel.y() << ") is none. Calibrate again, with the pattern all over the picture";
      throw ConfigError("camera.distortion", problem.str());
    }
}

}  // namespace

void CameraModel::validate() const {
  require(width >= kMinFrameSide && width <= kMaxFrameSide, "width", width, "16 to 16384 px");
  require(height >= kMinFrameSide && height <= kMaxFrameSide, "height", height, "16 to 16384 px");
  const double longest = std::max(width, height);
  for (auto [key, value] : {std::pair{"fx", fx}, std::pair{"fy", fy}})
    require(std::isfinite(value) && value > 0.1 * longest && value < 100.0 * longest, key, value,
            "a focal length in pixels lies between 0.1 and 100 image sides");
  // Pixels are square within a few percent, so comparing the two focal lengths reveals more than each alone.
  const double aspect = fx / fy;
  if (!(aspect > 1.0 / kMaxAspect && aspect < kMaxAspect)) {
    std::ostringstream problem;
    problem << fx << " beside fy = " << fy << " is not allowed; pixels are nearly square, fx / fy lies between "
            << 1.0 / kMaxAspect << " and " << kMaxAspect;
    throw ConfigError("camera.fx", problem.str());
  }
  require(std::isfinite(cx) && cx > 0.0 && cx < width, "cx", cx, "the principal point lies in the image");
  require(std::isfinite(cy) && cy > 0.0 && cy < height, "cy", cy, "the principal point lies in the image");
  for (auto [key, value] :
       {std::pair{"k1", k1}, std::pair{"k2", k2}, std::pair{"p1", p1}, std::pair{"p2", p2}, std::pair{"k3", k3}})
    require(std::isfinite(value), key, value, "distortion must be finite");
  check_lens(*this);
}

Eigen::Vector2d project_normalized(const CameraModel& camera, const Eigen::Vector2d& normalized) {
  const Eigen::Vector2d distorted = distort(camera, normalized);
  return {camera.fx * distorted.x() + camera.cx, camera.fy * distorted.y() + camera.cy};
}

Eigen::Matrix2d pixels_from_normalized(const CameraModel& camera, const Eigen::Vector2d& normalized) {
  return Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() * distort_jacobian(camera, normalized);
}

std::optional<Eigen::Vector2d> project(const CameraModel& camera, const Eigen::Vector3d& point_c) {
  if (!(point_c.z() > 1e-9)) return std::nullopt;
  return project_normalized(camera, Eigen::Vector2d(point_c.head<2>() / point_c.z()));
}

Eigen::Vector2d normalize_pixel(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  Eigen::Vector2d target((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
  if (!camera.has_distortion()) return target;
  Eigen::Vector2d point = target;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Eigen::Vector2d residual = distort(camera, point) - target;
    const Eigen::Vector2d correction = distort_jacobian(camera, point).inverse() * residual;
    if (!correction.allFinite()) break;
    point -= correction;
    if (correction.squaredNorm() < 1e-26) break;
  }
  return point;
}

Eigen::Isometry3d base_from_camera(const CameraMounting& mounting) {
  // Columns: where the camera's right, down and forward point in the base frame when all angles are zero.
  Eigen::Matrix3d looking_ahead;
  looking_ahead << 0, 0, 1,  //
      -1, 0, 0,              //
      0, -1, 0;
  // In the base frame, looking up is a negative turn about y (left); clockwise roll is a positive turn about x.
  const Eigen::Matrix3d turned = (Eigen::AngleAxisd(mounting.pan_rad, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(-mounting.tilt_rad, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(mounting.roll_rad, Eigen::Vector3d::UnitX()))
                                     .toRotationMatrix();
  Eigen::Isometry3d bMc = Eigen::Isometry3d::Identity();
  bMc.linear() = turned * looking_ahead;
  bMc.translation() = Eigen::Vector3d(mounting.position_m[0], mounting.position_m[1], mounting.position_m[2]);
  return bMc;
}

}  // namespace pilotfish
