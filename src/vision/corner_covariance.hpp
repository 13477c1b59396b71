#pragma once

#include "registration_task.hpp"

namespace pilotfish::vision {

/// Of the corners in the picture [px^2], AprilTag's order (u0, v0, u1, v1, ...), from the last step of the fit: the
/// noise that its residuals show, and more where they are not independent.
Matrix8d corner_covariance(const CameraModel& camera, const Fit& fit, const Task& task);

}  // namespace pilotfish::vision
