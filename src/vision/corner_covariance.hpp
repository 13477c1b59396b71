#pragma once

#include "registration_task.hpp"

namespace pilotfish::vision {

/// How exactly the corners are known.
struct CornerCovariance {
  Matrix8d px2 = Matrix8d::Zero();  ///< AprilTag's order (u0, v0, u1, v1, ...)
  double agreement = 1.0;           ///< how many times more the residuals move the tag than independent ones would
};

/// Of the corners in the picture, on a bent sheet of those of its tangent plane, from the last step of the fit: the
/// noise that its residuals show, and more where they are not independent.
CornerCovariance corner_covariance(const CameraModel& camera, const Fit& fit, const Task& task);

}  // namespace pilotfish::vision
