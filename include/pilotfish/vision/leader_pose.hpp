#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/refused_value.hpp"
#include "pilotfish/core/se3.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/vision/tag_measurement.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// Which poses are accepted, and how exactly.
struct LeaderPoseConfig {
  PILOTFISH_PARAMETERS(LeaderPoseConfig);
  PILOTFISH_PARAMETER(double, max_reprojection_error_px, 3.0, 0.01, 100.0,
                      "RMS distance between seen and projected corners above which a pose is refused");
  PILOTFISH_PARAMETER(double, corner_sigma_px, 0.005, 0.0, 10.0,
                      "standard deviation of each corner coordinate that is added to its measured noise: the "
                      "errors of calibration and print");
  PILOTFISH_PARAMETER(double, min_distance_m, 0.05, 0.01, 1000.0,
                      "camera to tag; a tag whose size in the picture means that it is nearer is refused");
  PILOTFISH_PARAMETER(double, max_distance_m, 20.0, 0.1, 1000.0,
                      "camera to tag; a tag whose size in the picture means that it is farther is refused");
};

/// One pose that explains the corners at least locally best.
struct PoseSolution {
  Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();  ///< leader's base frame to camera frame
  /// Of the twist (v, w), in the camera frame, whose exponential acts on cMo from the left.
  Matrix6d covariance = Matrix6d::Zero();
  double squared_error = 0.0;          ///< chi-squared: of the corners, in units of their covariance
  double reprojection_error_px = 0.0;  ///< RMS over the corners, in the picture as it is (distorted)
};

/// A pose cMo and how well it explains the corners.
struct LeaderPose {
  PoseSolution best;                  ///< the one to use
  std::optional<PoseSolution> other;  ///< the second planar solution: the next best one that is really different
  double ambiguity_ratio = kMaxAmbiguityRatio;  ///< see Observation
};

/// One pose from all corners of all tags, each with its covariance. Starts: `guess`, if there is one, else the pose
/// that the largest tag has by itself; and its mirror image about the line of sight, near which a plane's other
/// solution lies. Each start is refined over all corners by virtual visual servoing. Nothing if no start converges in
/// front of the camera, if there is no tag, or if one is not on the body. Gates are the caller's: see check_pose().
/// Never throws, never allocates.
std::optional<LeaderPose> estimate_leader_pose(const CameraModel& camera, const LeaderBody& body,
                                               const TagMeasurements& tags, const LeaderPoseConfig& config,
                                               const std::optional<Eigen::Isometry3d>& guess = std::nullopt) noexcept;

/// What check_pose() says.
struct PoseVerdict {
  Reason reason = Reason::none;  ///< none: the pose passes
  RefusedValue refused;          ///< what the gate compared, if it compared numbers
};

/// Reason::none if the pose explains the corners well enough, with every tag in front of the camera, its
/// printed side towards it, and of the size that it must have at its range.
PoseVerdict check_pose(const PoseSolution& pose, const LeaderBody& body, const TagMeasurements& tags,
                       const LeaderPoseConfig& config) noexcept;

}  // namespace pilotfish::vision
PILOTFISH_API_END
