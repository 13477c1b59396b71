#include "pose_candidates.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::vision {
namespace {

/// d, theta, psi and their covariance. With t = cMo's translation, f = cMo's first column (the leader's
/// forward axis) and R the rotation of bMc, a small twist (v, w) acting on cMo from the left moves them by
///
///   dt = v + w x t = v - [t]x w,      df = w x f = -[f]x w       in the camera frame, R times that in the
///   base frame.
///
/// With p = bMo's translation and g = R f, both in the base frame,
///
///   d = hypot(px, py)      dd     = (px dpx + py dpy) / d
///   theta = atan2(py, px)  dtheta = (px dpy - py dpx) / d^2
///   psi = atan2(gy, gx)    dpsi   = (gx dgy - gy dgx) / (gx^2 + gy^2)
///
/// At d = 0, or with the leader's nose straight up, this is not finite; the caller checks.
RelativeMeasurement relative_measurement(const Eigen::Isometry3d& bMc, const PoseSolution& pose) {
  const Eigen::Vector3d t = pose.cMo.translation(), f = pose.cMo.linear().col(0);
  Eigen::Matrix<double, 3, 6> dp, dg;
  dp << bMc.linear(), -bMc.linear() * se3::hat(t);
  dg << Eigen::Matrix3d::Zero(), -bMc.linear() * se3::hat(f);

  const Eigen::Vector3d p = bMc * t, g = bMc.linear() * f;
  const double d2 = p.head<2>().squaredNorm(), g2 = g.head<2>().squaredNorm();
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian.row(0) = (p.x() * dp.row(0) + p.y() * dp.row(1)) / std::sqrt(d2);
  jacobian.row(1) = (p.x() * dp.row(1) - p.y() * dp.row(0)) / d2;
  jacobian.row(2) = (g.x() * dg.row(1) - g.y() * dg.row(0)) / g2;
  return {relative_pose(bMc * pose.cMo), jacobian * pose.covariance * jacobian.transpose()};
}

/// Robots drive upright. One that leans farther is seen by a camera that is mounted upside down, or was told so.
constexpr double kMostLean_deg = 120.0;

double lean_deg(const Eigen::Isometry3d& bMc, const PoseSolution& pose) {
  return degrees(std::acos(std::clamp((bMc.linear() * pose.cMo.linear())(2, 2), -1.0, 1.0)));
}

}  // namespace

bool is_finite(const RelativeMeasurement& m) {
  return std::isfinite(m.pose.distance_m) && std::isfinite(m.pose.bearing_rad) && std::isfinite(m.pose.heading_rad) &&
         m.covariance.allFinite();
}

PoseCandidates pose_candidates(const CameraModel& camera, const LeaderBody& body, const Eigen::Isometry3d& bMc,
                               const TagMeasurements& tags, const LeaderPoseConfig& config,
                               const std::optional<Eigen::Isometry3d>& predicted_cMo) noexcept {
  PoseCandidates found;
  const std::optional<LeaderPose> pose = estimate_leader_pose(camera, body, tags, config, predicted_cMo);
  if (pose)
    found.verdict = check_pose(pose->best, body, tags, config);
  else
    found.verdict.reason = Reason::pose_refused;
  if (found.verdict.reason != Reason::none) return found;
  if (const double lean = lean_deg(bMc, pose->best); !(lean <= kMostLean_deg)) {
    found.verdict = {Reason::leader_upside_down, at_most("lean of the leader", lean, kMostLean_deg, "deg")};
    return found;
  }

  found.ambiguity_ratio = pose->ambiguity_ratio;
  found.solutions.push_back(pose->best);
  if (pose->other && check_pose(*pose->other, body, tags, config).reason == Reason::none &&
      lean_deg(bMc, *pose->other) <= kMostLean_deg)
    found.solutions.push_back(*pose->other);
  for (const PoseSolution& solution : found.solutions) {
    found.candidates.push_back({relative_measurement(bMc, solution), solution.squared_error});
    if (!is_finite(found.candidates.back().measurement)) found.verdict.reason = Reason::pose_refused;
  }
  return found;
}

}  // namespace pilotfish::vision
