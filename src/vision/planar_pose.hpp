#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace pilotfish::vision {

/// The pose of a square from its homography (tag coordinates to Z = 1). Its columns are, up to one factor, h r1, h r2
/// and t with h half the side: the factor that makes the first two as long as h on average, and the rotation nearest to
/// them.
inline Eigen::Isometry3d pose_from_homography(const Eigen::Matrix3d& nHt, double size_m) {
  const double columns = std::sqrt(nHt.col(0).norm() * nHt.col(1).norm());
  const Eigen::Matrix3d M = (nHt(2, 2) < 0.0 ? -1.0 : 1.0) * nHt / columns;
  // Two unit vectors' sum and difference are perpendicular; half way between those lie the nearest perpendicular two.
  const Eigen::Vector3d a = M.col(0).normalized(), b = M.col(1).normalized();
  const Eigen::Vector3d sum = (a + b).normalized(), difference = (a - b).normalized();
  Eigen::Isometry3d cMt = Eigen::Isometry3d::Identity();
  cMt.linear().col(0) = (sum + difference) * std::sqrt(0.5);
  cMt.linear().col(1) = (sum - difference) * std::sqrt(0.5);
  cMt.linear().col(2) = cMt.linear().col(0).cross(cMt.linear().col(1));
  cMt.translation() = 0.5 * size_m * M.col(2);
  return cMt;
}

/// Where the other solution of a plane's pose lies, nearly: with its normal mirrored about the line of sight to its
/// middle (Schweighofer and Pinz, "Robust pose estimation from a planar target", 2006). Half a turn about the line of
/// sight does that to the normal, and half a turn about the normal puts the template upright again.
inline Eigen::Isometry3d mirrored_about_line_of_sight(const Eigen::Isometry3d& cMt) {
  const double pi = std::acos(-1.0);
  Eigen::Isometry3d mirrored = cMt;
  mirrored.linear() = Eigen::AngleAxisd(pi, cMt.translation().normalized()) * cMt.linear() *
                      Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitZ());
  return mirrored;
}

}  // namespace pilotfish::vision
