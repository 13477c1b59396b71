#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace pilotfish {

/// One tag of the leader in one picture.
struct TagSighting {
  int id = 0;
  int hamming = 0;                            ///< corrected bits
  double decision_margin = 0.0;               ///< AprilTag's: mean contrast of the bits, in gray levels
  std::array<Eigen::Vector2d, 4> corners_px;  ///< bottom left, bottom right, top right, top left, as one reads the tag
};

/// The leader, measured in one frame. It exists only if every check passed.
struct Observation {
  std::int64_t utime = 0;    ///< exposure of the frame [us]
  double distance_m = 0.0;   ///< d = hypot(x, y) of the leader's base origin in the coordinator's base frame
  double bearing_rad = 0.0;  ///< theta = atan2(y, x), positive: to the left
  double heading_rad = 0.0;  ///< psi: the leader's heading relative to the coordinator's
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();   ///< of (distance_m, bearing_rad, heading_rad)
  Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();  ///< leader's base frame to camera frame
  double reprojection_error_px = 0.0;                     ///< RMS over all corners used
  /// Reprojection error of the other planar solution over this one's (>= 1). Near 1 the heading cannot be told from one
  /// picture; with tags in more than one plane it is infinite in principle and capped at kMaxAmbiguityRatio.
  double ambiguity_ratio = 1.0;
  double min_decision_margin = 0.0;  ///< of the tags used
  std::vector<TagSighting> tags;
};

inline constexpr double kMaxAmbiguityRatio = 1e6;

/// The leader's base origin relative to the coordinator's, from its pose: the single place where d, theta, psi are
/// read.
struct RelativePose {
  double distance_m = 0.0, bearing_rad = 0.0, heading_rad = 0.0;
};
RelativePose relative_pose(const Eigen::Isometry3d& bMo);

}  // namespace pilotfish
