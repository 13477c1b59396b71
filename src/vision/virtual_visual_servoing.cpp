#include "virtual_visual_servoing.hpp"

#include <algorithm>
#include <cmath>

// Virtual visual servoing (Marchand and Chaumette, "Virtual visual servoing: a framework for real-time augmented
// reality", 2002): pose computation as the visual servoing of a virtual camera. With s(cMo) the projected points on the
// plane Z = 1 and s* the measured ones, the camera's velocity v changes the features by ds = L v, where for one point
// (Chaumette and Hutchinson, "Visual servo control I", 2006, eq. 11)
//
//   L = [ -1/Z   0    x/Z   x y      -(1 + x^2)   y ]
//       [  0    -1/Z  y/Z   1 + y^2  -x y        -x ]
//
// The error counts in standard deviations of the corners, e = A (s - s*), with A the whitening of SquareSighting (which
// treats the distortion as linear over the residual: off by the residual times the distortion's curvature). With J = A
// L the step is
//
//   v = -(J^T J + lambda diag(J^T J))^-1 J^T e,      cMo <- exp(v)^-1 cMo.
//
// Levenberg's lambda makes every accepted step go downhill, so that it converges from far; towards the end lambda
// vanishes and the step is Gauss-Newton's. ViSP computes the same; L is written out here because ViSP's matrices
// allocate.

namespace pilotfish::vision {
namespace {

constexpr double kNearest_m = 1e-3;  ///< nothing is seen closer to the camera than this
constexpr int kMaxIterations = 100;
constexpr double kMaxDamping = 1e9;
/// A step whose predicted decrease of the squared error, in squared standard deviations, is less than this is none: a
/// ten thousandth of a sigma.
constexpr double kConverged = 1e-8;

struct PoseEquations {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double squared_error = 0.0;
};

/// Nothing if a corner is not in front of the camera.
std::optional<PoseEquations> linearize(const Eigen::Isometry3d& cMo, const SquareSightings& squares) {
  PoseEquations sum;
  for (const SquareSighting& square : squares) {
    Eigen::Matrix<double, 8, 6> L;
    Eigen::Matrix<double, 8, 1> difference;
    for (Eigen::Index i = 0; i < 4; ++i) {
      const Eigen::Vector3d point_c = cMo * square.corners_o[i];
      if (!(point_c.z() > kNearest_m)) return std::nullopt;
      const double Z = point_c.z(), x = point_c.x() / Z, y = point_c.y() / Z;
      L.row(2 * i) << -1.0 / Z, 0.0, x / Z, x * y, -(1.0 + x * x), y;
      L.row(2 * i + 1) << 0.0, -1.0 / Z, y / Z, 1.0 + y * y, -x * y, -x;
      difference.segment<2>(2 * i) = Eigen::Vector2d(x, y) - square.normalized[i];
    }
    const Eigen::Matrix<double, 8, 6> J = square.whitening * L;
    const Eigen::Matrix<double, 8, 1> error = square.whitening * difference;
    sum.information.noalias() += J.transpose() * J;
    sum.gradient.noalias() += J.transpose() * error;
    sum.squared_error += error.squaredNorm();
  }
  return sum;
}

}  // namespace

std::optional<LocalMinimum> servo_virtually(const Eigen::Isometry3d& start, const SquareSightings& squares) {
  Eigen::Isometry3d cMo = start;
  std::optional<PoseEquations> here = linearize(cMo, squares);
  if (!here) return std::nullopt;
  double damping = 1e-6;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Matrix6d damped = here->information;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d step = -damped.ldlt().solve(here->gradient);
    if (!step.allFinite()) return std::nullopt;
    const bool converged = -step.dot(here->gradient) < kConverged || damping > kMaxDamping;
    if (converged) return LocalMinimum{cMo, here->information, here->squared_error};

    const Eigen::Isometry3d there_cMo = se3::exp(step).inverse() * cMo;
    const std::optional<PoseEquations> there = linearize(there_cMo, squares);
    if (there && there->squared_error < here->squared_error) {
      cMo = there_cMo;
      here = there;
      damping = std::max(damping / 10.0, 1e-12);
    } else {
      damping = std::max(damping * 10.0, 1e-4);
    }
  }
  return std::nullopt;
}

}  // namespace pilotfish::vision
