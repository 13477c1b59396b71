#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "pilotfish/api.hpp"
#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/leader_body.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// One tag of the leader in one picture.
struct TagDetection {
  int id = 0;                                 ///< number of the tag in its family
  int hamming = 0;                            ///< corrected bits
  double decision_margin = 0.0;               ///< AprilTag's: mean contrast of the bits, in gray levels
  std::array<Eigen::Vector2d, 4> corners_px;  ///< bottom left, bottom right, top right, top left, as one reads the tag
};

inline constexpr double kMaxAmbiguityRatio = 1e6;

/// The leader's base origin relative to the coordinator's.
struct RelativePose {
  double distance_m = 0.0;   ///< d = hypot(x, y) of the leader's base origin in the coordinator's base frame
  double bearing_rad = 0.0;  ///< theta = atan2(y, x), positive: to the left
  double heading_rad = 0.0;  ///< psi: the leader's heading relative to the coordinator's
};
/// The single place where d, theta, psi are read from a pose.
RelativePose relative_pose(const Eigen::Isometry3d& bMo);

/// How the leader's tags were found in a frame.
enum class FoundBy : std::uint8_t {
  track,   ///< at the place predicted from the motion so far
  region,  ///< by a detection around that place
  frame,   ///< by a detection in the whole frame
};

std::string_view to_string(FoundBy found_by) noexcept;

/// The measurement of one frame alone, with the planar solution that the headings so far favour.
struct RelativeMeasurement {
  RelativePose pose;                                     ///< distance, bearing and heading
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (distance_m, bearing_rad, heading_rad)
  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.pose, self.covariance);
  }
};

/// The leader, measured in one frame. It exists only if every check passed.
struct Observation {
  std::int64_t utime = 0;  ///< exposure of the frame [us]
  /// The heading comes from a filter over the frames, which selects one of the two planar solutions; distance and
  /// bearing are this frame's, as far as they depend on the heading with the filter's (the base origin lies behind the
  /// tag).
  double distance_m = 0.0;
  double bearing_rad = 0.0;  ///< theta = atan2(y, x) [rad], positive: to the left
  double heading_rad = 0.0;  ///< psi, the leader's heading relative to the coordinator's, filtered
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of the three above
  RelativeMeasurement measured;    ///< of this frame alone: what a filter of your own should be fed; may be left out
  double heading_ambiguity = 0.0;  ///< probability, from the headings so far, of another one than heading_rad

  Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();  ///< leader's base frame to camera frame, of this frame alone
  std::optional<Eigen::Isometry3d> other_cMo;             ///< the other planar solution, if there is one
  /// Error of the worse planar solution over the better one's, in standard deviations of the corners (>= 1). Near 1 the
  /// heading is undetermined by one picture; kMaxAmbiguityRatio where there is no second solution.
  double ambiguity_ratio = 1.0;
  double reprojection_error_px = 0.0;                ///< RMS over all corners used
  double min_decision_margin = 0.0;                  ///< of the tags used
  FoundBy found_by = FoundBy::frame;                 ///< how the tags were found
  BoundedVector<TagDetection, kMaxTagsOnBody> tags;  ///< those used

  /// `measured`; or the pose and covariance above, where whoever made this observation gave no other.
  RelativeMeasurement of_this_frame() const {
    if (measured.pose.distance_m > 0.0) return measured;
    return {{distance_m, bearing_rad, heading_rad}, covariance};
  }
};

}  // namespace pilotfish
PILOTFISH_API_END
