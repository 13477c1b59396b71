#pragma once

#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/vision/heading_filter.hpp"
#include "pilotfish/vision/leader_pose.hpp"

namespace pilotfish::vision {

/// The planar solutions of one picture that pass the gates, the better one first, and what each of them says.
struct PoseCandidates {
  PoseVerdict verdict;                            ///< why there is none
  BoundedVector<PoseSolution, 2> solutions;       ///< one or two
  BoundedVector<HeadingCandidate, 2> candidates;  ///< of each solution; all finite
  double ambiguity_ratio = kMaxAmbiguityRatio;    ///< see Observation
};

/// The pose stage: estimate_leader_pose() and check_pose(), and from camera to base frame. Never throws, never
/// allocates.
PoseCandidates pose_candidates(const CameraModel& camera, const LeaderBody& body, const Eigen::Isometry3d& bMc,
                               const TagMeasurements& tags, const LeaderPoseConfig& config,
                               const std::optional<Eigen::Isometry3d>& predicted_cMo) noexcept;

bool is_finite(const RelativeMeasurement& measurement);

}  // namespace pilotfish::vision
