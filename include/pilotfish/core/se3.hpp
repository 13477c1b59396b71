#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Rigid motions as exponentials of twists. An element of se(3) is (v, w): translational and rotational
/// velocity [m, rad per unit of time], in that order; its exponential is the motion after one unit of time. As it acts
/// from the left here, v and w are given in the frame that the motion leads to: cMo(t) = exp(t (v, w)) cMo(0) for an
/// object that moves by (v, w) in the camera's frame.
namespace se3 {

/// [a]x, the cross product as a matrix: hat(a) b = a x b.
inline Eigen::Matrix3d hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d matrix;
  matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return matrix;
}

/// V with translation = V v: I + (1 - cos a) / a^2 [w]x + (a - sin a) / a^3 [w]x^2, a = |w|. Below 1e-4
/// the differences would be rounding; the series' next terms are below 1e-18.
inline Eigen::Matrix3d translation_factor(const Eigen::Vector3d& w) {
  const double a2 = w.squaredNorm(), a = std::sqrt(a2);
  const double b = a < 1e-4 ? 0.5 - a2 / 24.0 : (1.0 - std::cos(a)) / a2;
  const double c = a < 1e-4 ? 1.0 / 6.0 - a2 / 120.0 : (a - std::sin(a)) / (a2 * a);
  const Eigen::Matrix3d W = hat(w);
  return Eigen::Matrix3d::Identity() + b * W + c * W * W;
}

/// The motion with constant (v, w) for one unit of time.
inline Eigen::Isometry3d exp(const Vector6d& velocity) {
  const Eigen::Vector3d w = velocity.tail<3>();
  const double angle = w.norm();
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (angle > 0.0) motion.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  motion.translation() = translation_factor(w) * velocity.head<3>();
  return motion;
}

/// The inverse of exp(): the (v, w) with the smallest turn that does `motion`, for turns below pi. At half a turn the
/// axis may come with either sign.
inline Vector6d log(const Eigen::Isometry3d& motion) {
  const Eigen::AngleAxisd turn(motion.linear());
  Vector6d velocity;
  velocity.tail<3>() = turn.angle() * turn.axis();
  velocity.head<3>() = translation_factor(velocity.tail<3>()).inverse() * motion.translation();
  return velocity;
}

/// By how much two orientations differ [rad], 0 to pi.
inline double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

}  // namespace se3
}  // namespace pilotfish
PILOTFISH_API_END
