#include "pilotfish/core/camera_model.hpp"

#include <cmath>

#include "lens.hpp"
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

/// Each direction has an angle of its own in the picture, up to the corners without their outermost tenth (as above) or
/// up to 89 degrees, and none is moved beyond five times or a fifth of its angle.
void check_fisheye(const CameraModel& camera) {
  constexpr double kMargin = 0.1, kMaxStretch = 5.0, kSteps = 89.0;
  double farthest = 0.0;
  for (double u : {kMargin, 1.0 - kMargin})
    for (double v : {kMargin, 1.0 - kMargin})
      farthest = std::max(farthest, std::hypot((u * camera.width - camera.cx) / camera.fx,
                                               (v * camera.height - camera.cy) / camera.fy));
  double before = 0.0;
  for (double step = 1.0; step <= kSteps && before < farthest; step += 1.0) {
    const double angle = radians(step);
    const double bent = distort(camera, {std::tan(angle), 0.0}).x();
    if (bent > before && bent < kMaxStretch * angle && bent > angle / kMaxStretch) {
      before = bent;
      continue;
    }
    std::ostringstream problem;
    problem << "k1 = " << camera.k1 << ", k2 = " << camera.k2 << ", k3 = " << camera.k3 << ", k4 = " << camera.k4
            << " is no fisheye: allowed is what leads every direction to a place of its own, at " << 1.0 / kMaxStretch
            << " to " << kMaxStretch << " times its angle; " << step << " degrees off the axis it does not. Calibrate "
            << "again, with the pattern all over the picture";
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
  for (auto [key, value] : {std::pair{"k1", k1}, std::pair{"k2", k2}, std::pair{"p1", p1}, std::pair{"p2", p2},
                            std::pair{"k3", k3}, std::pair{"k4", k4}})
    require(std::isfinite(value), key, value, "distortion must be finite");
  require(readout_s >= 0.0 && readout_s <= kMaxReadout_s, "readout_s", readout_s, "0 to 0.1 s");
  const bool fisheye = lens == Lens::kannala_brandt;
  require(fisheye || k4 == 0.0, "k4", k4, "only a Kannala-Brandt lens has it");
  for (auto [key, value] : {std::pair{"p1", p1}, std::pair{"p2", p2}})
    require(!fisheye || value == 0.0, key, value, "a Kannala-Brandt lens has none");
  if (fisheye)
    check_fisheye(*this);
  else
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
  return undistort(camera, {(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy});
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
