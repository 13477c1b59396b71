#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "pilotfish/core/camera_model.hpp"

namespace pilotfish::vision {

/// A homography from tag coordinates to the "flat picture" g, with eight parameters h that are all of the size of
/// pixels:
///
///   D = h7 x + h8 y + 1,   g = ((h1 x + h2 y + h3) / D, (h4 x + h5 y + h6) / D)
///   n = n0 + g / f         the undistorted plane Z = 1, f = sqrt(fx fy), n0 where the tag's middle was at the start
///   pixel = the camera model of n
///
/// So g is the picture without its distortion, in pixels, relative to the tag's middle. Distortion acts on points,
/// never on the picture.
///
/// The sheet may be bent. Then the homography is that of the plane that touches it in the middle, from which the sheet
/// departs by z along the normal; with Q the curvatures (bend: Qxx, Qxy, Qyy; per half a side of the tag), and since
/// bending keeps lengths on the sheet,
///
///   z = s^T Q s / 2,   (X, Y) = s - z / 3 Q s   (to the third order of a cylinder, R sin(s / R))
///   g = ((h1 X + h2 Y + h3 + m1 z) / D, (h4 X + h5 Y + h6 + m2 z) / D),   D = h7 X + h8 Y + 1 + m3 z
///
/// with m the column of the normal, which for a calibrated camera is the cross product of the first two.
class TagWarp {
 public:
  using Parameters = Eigen::Matrix<double, 8, 1>;

  TagWarp(const CameraModel& camera, const Eigen::Matrix3d& nHt,
          const Eigen::Vector3d& curvatures = Eigen::Vector3d::Zero())
      : bend(curvatures), scale_(1.0 / std::sqrt(camera.fx * camera.fy)) {
    const Eigen::Matrix3d H = nHt / nHt(2, 2);
    middle_ = H.col(2).head<2>();
    for (Eigen::Index i = 0; i < 2; ++i) h.segment<3>(3 * i) = (H.row(i) - middle_[i] * H.row(2)).transpose() / scale_;
    h.tail<2>() = H.row(2).head<2>().transpose();
    if (is_bent()) aim_normal();
  }

  bool is_finite() const { return h.allFinite() && middle_.allFinite(); }
  bool is_bent() const { return !bend.isZero(0.0); }

  /// The plane that touches the sheet in the middle of the tag.
  TagWarp tangent() const {
    TagWarp plane = *this;
    plane.bend.setZero();
    return plane;
  }

  /// After a change of h: the normal's column follows.
  void aim_normal() {
    const Eigen::Matrix3d H = nHt();
    const Eigen::Vector3d along = H.col(0).cross(H.col(1)) / std::sqrt(H.col(0).norm() * H.col(1).norm());
    normal.head<2>() = (along.head<2>() - along.z() * middle_) / scale_;
    normal.z() = along.z();
  }

  double D(const Eigen::Vector2d& tag) const { return h[6] * tag.x() + h[7] * tag.y() + 1.0; }

  Eigen::Vector2d flat(const Eigen::Vector2d& tag) const {
    if (is_bent()) return bent(tag).g;
    const double x = tag.x(), y = tag.y();
    return Eigen::Vector2d(h[0] * x + h[1] * y + h[2], h[3] * x + h[4] * y + h[5]) / D(tag);
  }

  /// dg / d(x, y)
  Eigen::Matrix2d flat_jacobian(const Eigen::Vector2d& tag) const {
    if (is_bent()) return bent(tag).jacobian;
    const Eigen::Vector2d g = flat(tag);
    Eigen::Matrix2d J;
    J << h[0] - g.x() * h[6], h[1] - g.x() * h[7], h[3] - g.y() * h[6], h[4] - g.y() * h[7];
    return J / D(tag);
  }

  Eigen::Vector2d pixel(const CameraModel& camera, const Eigen::Vector2d& g) const {
    return project_normalized(camera, middle_ + scale_ * g);
  }

  /// dpixel / dg
  Eigen::Matrix2d pixel_jacobian(const CameraModel& camera, const Eigen::Vector2d& g) const {
    return scale_ * pixels_from_normalized(camera, middle_ + scale_ * g);
  }

  /// The point of the tag that is seen at g, `inverse` that of matrix(). On a bent sheet by Newton's method.
  Eigen::Vector2d tag(const Eigen::Matrix3d& inverse, const Eigen::Vector2d& g) const {
    Eigen::Vector2d s = (inverse * g.homogeneous()).hnormalized();
    for (int step = 0; is_bent() && step < kInversionSteps; ++step) {
      const Bent at = bent(s);
      s -= at.jacobian.inverse() * (at.g - g);
    }
    return s;
  }

  /// w^T dg/dh for any w, of a plane.
  Parameters gradient(const Eigen::Vector2d& tag, const Eigen::Vector2d& w) const {
    const Eigen::Vector2d a = w / D(tag);
    const double c = -a.dot(flat(tag));
    Parameters row;
    row << a.x() * tag.x(), a.x() * tag.y(), a.x(), a.y() * tag.x(), a.y() * tag.y(), a.y(), c * tag.x(), c * tag.y();
    return row;
  }

  /// Tag coordinates to g, homogeneous.
  Eigen::Matrix3d matrix() const {
    Eigen::Matrix3d H;
    H << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1.0;
    return H;
  }

  /// Tag coordinates to the plane Z = 1, homogeneous.
  Eigen::Matrix3d nHt() const {
    Eigen::Matrix3d nMg;
    nMg << scale_, 0, middle_.x(), 0, scale_, middle_.y(), 0, 0, 1;
    return nMg * matrix();
  }

  static constexpr int kInversionSteps = 3;

  Parameters h = Parameters::Zero();
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();    ///< curvatures Qxx, Qxy, Qyy; zero: a plane
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< m, of a bent sheet

 private:
  struct Bent {
    Eigen::Vector2d g;
    Eigen::Matrix2d jacobian;
  };
  Bent bent(const Eigen::Vector2d& s) const {
    Eigen::Matrix2d Q;
    Q << bend[0], bend[1], bend[1], bend[2];
    const Eigen::Vector2d slope = Q * s;
    const double z = 0.5 * s.dot(slope);
    const Eigen::Vector2d along = s - z / 3.0 * slope;
    const Eigen::Matrix3d M = matrix();
    const Eigen::Vector3d point = M * along.homogeneous() + z * normal;
    const Eigen::Matrix2d along_from_s = Eigen::Matrix2d::Identity() - (slope * slope.transpose() + z * Q) / 3.0;
    const Eigen::Matrix<double, 3, 2> d = M.leftCols<2>() * along_from_s + normal * slope.transpose();
    const Eigen::Vector2d g = point.hnormalized();
    return {g, (d.topRows<2>() - g * d.row(2)) / point.z()};
  }

  double scale_;
  Eigen::Vector2d middle_;
};

/// The square's corners in tag coordinates, in AprilTag's order.
inline const std::array<Eigen::Vector2d, 4>& tag_corners() {
  static const std::array<Eigen::Vector2d, 4> corners = {Eigen::Vector2d(-1, 1), {1, 1}, {1, -1}, {-1, -1}};
  return corners;
}

/// The same in the picture [px], or those of a square `reach` times as large.
inline std::array<Eigen::Vector2d, 4> tag_corners_px(const CameraModel& camera, const TagWarp& warp,
                                                     double reach = 1.0) {
  std::array<Eigen::Vector2d, 4> corners_px;
  for (std::size_t i = 0; i < corners_px.size(); ++i)
    corners_px[i] = warp.pixel(camera, warp.flat(reach * tag_corners()[i]));
  return corners_px;
}

/// The third component of a x b.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Half the cross product of the diagonals.
inline double quadrilateral_area(const std::array<Eigen::Vector2d, 4>& corners) {
  const Eigen::Vector2d a = corners[2] - corners[0], b = corners[3] - corners[1];
  return 0.5 * std::abs(cross(a, b));
}

}  // namespace pilotfish::vision
