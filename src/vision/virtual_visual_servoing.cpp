#include "virtual_visual_servoing.hpp"

#include <visp3/core/vpExponentialMap.h>
#include <visp3/visual_features/vpFeaturePoint.h>

// Virtual visual servoing (Marchand and Chaumette, "Virtual visual servoing: a framework for real-time
// augmented reality", 2002): pose computation as the visual servoing of a virtual camera. With s(cMo) the
// projected points on the plane Z = 1 and s* the measured ones, the camera's velocity v changes the features
// by ds = L v, where for one point (Chaumette and Hutchinson, "Visual servo control I", 2006, eq. 11)
//
//   L = [ -1/Z   0    x/Z   x y      -(1 + x^2)   y ]
//       [  0    -1/Z  y/Z   1 + y^2  -x y        -x ]
//
// which is vpFeaturePoint::interaction(). We want the error in pixels, e = W (s - s*) with W the derivative
// of the pixel by the normalised point, taken once, at s*: diag(fx, fy), times the derivative of the
// distortion. (So the distortion is treated as linear over the residual: exact without distortion, and off by
// the residual times the distortion's curvature otherwise: 1e-3 of a one-pixel residual for k1 = -0.3.) With
// J = W L the step is
//
//   v = -(J^T J + lambda diag(J^T J))^-1 J^T e,      cMo <- exp(v)^-1 cMo
//
// with exp = vpExponentialMap::direct().
//
// Levenberg's lambda makes every accepted step go downhill, so that it converges from far; towards the end
// lambda vanishes and the step is Gauss-Newton's.

namespace pilotfish::vision {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kNearest_m = 1e-3;  ///< nothing is seen closer to the camera than this
constexpr int kMaxIterations = 100;
constexpr double kMaxDamping = 1e9;

struct NormalEquations {
  Matrix6d information = Matrix6d::Zero();  ///< sum of J^T J
  Vector6d gradient = Vector6d::Zero();     ///< sum of J^T e
  double squared_error = 0.0;               ///< [px^2]
};

/// Nothing if a point is not in front of the camera.
std::optional<NormalEquations> linearize(const Eigen::Isometry3d& cMo, const std::vector<PointSighting>& points) {
  NormalEquations sum;
  vpFeaturePoint feature;
  for (const PointSighting& point : points) {
    const Eigen::Vector3d point_c = cMo * point.point_o;
    if (!(point_c.z() > kNearest_m)) return std::nullopt;
    const Eigen::Vector2d projected = point_c.head<2>() / point_c.z();
    feature.set_xyZ(projected.x(), projected.y(), point_c.z());
    const vpMatrix interaction = feature.interaction();
    const Eigen::Map<const Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> L(interaction.data);
    const Eigen::Matrix<double, 2, 6> jacobian = point.pixels_from_normalized * L;
    const Eigen::Vector2d error = point.pixels_from_normalized * (projected - point.normalized);
    sum.information += jacobian.transpose() * jacobian;
    sum.gradient += jacobian.transpose() * error;
    sum.squared_error += error.squaredNorm();
  }
  return sum;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& cMo, const Vector6d& camera_step) {
  vpColVector v(6);
  for (unsigned int i = 0; i < 6; ++i) v[i] = camera_step[i];
  const vpHomogeneousMatrix step = vpExponentialMap::direct(v);
  Eigen::Isometry3d old_from_new = Eigen::Isometry3d::Identity();
  old_from_new.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(step.data);
  return old_from_new.inverse() * cMo;
}

}  // namespace

std::optional<LocalMinimum> servo_virtually(const Eigen::Isometry3d& start, const std::vector<PointSighting>& points) {
  Eigen::Isometry3d cMo = start;
  std::optional<NormalEquations> here = linearize(cMo, points);
  if (!here) return std::nullopt;
  double damping = 1e-3;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Matrix6d damped = here->information;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d step = -damped.ldlt().solve(here->gradient);
    if (!step.allFinite()) return std::nullopt;
    // At rest when the step promises less than a millionth of a pixel, or when not even the smallest one goes downhill.
    const bool at_rest = -step.dot(here->gradient) < 1e-12 || damping > kMaxDamping;
    if (at_rest) return LocalMinimum{cMo, here->information};

    const Eigen::Isometry3d there_cMo = moved(cMo, step);
    const std::optional<NormalEquations> there = linearize(there_cMo, points);
    if (there && there->squared_error < here->squared_error) {
      cMo = there_cMo;
      here = there;
      damping = std::max(damping / 10.0, 1e-12);
    } else {
      damping *= 10.0;
    }
  }
  return std::nullopt;
}

}  // namespace pilotfish::vision
