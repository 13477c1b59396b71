#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"

namespace pilotfish::vision {

struct LeaderPoseConfig {
  double max_reprojection_error_px = 3.0;  ///< RMS over all corners
  double corner_sigma_px = 0.1;            ///< standard deviation of one corner coordinate, for the covariance
  double max_distance_m = 20.0;            ///< camera to tag; beyond, the pose is not believed
  static const std::vector<Parameter<LeaderPoseConfig>>& parameters();
};

/// A pose cMo and how well it explains the corners.
struct LeaderPose {
  Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();
  double reprojection_error_px = 0.0;           ///< RMS over the corners, in the picture as it is (distorted)
  double ambiguity_ratio = kMaxAmbiguityRatio;  ///< error of the second local minimum over this one's; see Observation
  /// Of the twist (v, w), in the camera frame, whose exponential acts on cMo from the left. It knows the
  /// bottom of the minimum it stands in; that there may be another one is said by the ambiguity ratio alone.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// One pose from all corners of all tags. Both planar solutions of each tag are starting points; each is
/// refined over all corners by virtual visual servoing (ViSP's interaction matrix of an image point); the
/// best wins, the best one that is really different sets the ambiguity ratio. Nothing if no start converges
/// in front of the camera, if there is no tag, or if one is not on the body. Gates are the caller's: see
/// is_credible(). Never throws.
std::optional<LeaderPose> estimate_leader_pose(const CameraModel& camera, const LeaderBody& body,
                                               const std::vector<TagSighting>& tags,
                                               const LeaderPoseConfig& config) noexcept;

/// Whether the pose explains the corners well enough, with every tag within the range that is believed, in
/// front of the camera and showing it its printed side.
bool is_credible(const LeaderPose& pose, const LeaderBody& body, const std::vector<TagSighting>& tags,
                 const LeaderPoseConfig& config) noexcept;

}  // namespace pilotfish::vision
