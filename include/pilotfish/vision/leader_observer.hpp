#pragma once

#include <cstdint>
#include <optional>

#include "pilotfish/vision/leader_pose.hpp"
#include "pilotfish/vision/tag_detector.hpp"

namespace pilotfish::vision {

struct LeaderObserverConfig {
  TagDetectorConfig detector;
  LeaderPoseConfig pose;
};

/// Everything that was turned away since the start, by reason.
struct RejectionCounters {
  std::int64_t frames_invalid = 0;
  std::int64_t hamming = 0;       ///< tags with more corrected bits than are believed
  std::int64_t margin = 0;        ///< tags with too little contrast
  std::int64_t foreign_id = 0;    ///< tags of the family that the leader does not wear
  std::int64_t duplicate_id = 0;  ///< an id seen twice in one picture: none of the two is believed
  std::int64_t pose = 0;          ///< corners that no credible pose explains
};

/// What one picture says about the leader: an observation, or the reason why there is none.
struct Sight {
  std::optional<Observation> observation;
  Reason reason = Reason::none;
};

/// The way into this room: Frame in, Observation out. detect -> keep the leader's tags -> one pose -> d,
/// theta, psi in the coordinator's base frame with their covariance.
class LeaderObserver {
 public:
  /// Throws ConfigError if any part is not usable.
  LeaderObserver(const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body,
                 const LeaderObserverConfig& config);

  /// Never throws. A frame whose size differs from the calibration's is refused, not scaled.
  Sight observe(const Frame& frame) noexcept;

  const RejectionCounters& rejected() const { return rejected_; }

 private:
  struct TagsOfLeader {
    std::vector<TagSighting> tags;
    Reason reason_if_empty = Reason::none;
  };
  Sight look(const Frame& frame);
  TagsOfLeader keep_tags_of_leader(Detections detections);  ///< counts all that it turns away

  CameraModel camera_;
  Eigen::Isometry3d bMc_;
  LeaderBody body_;
  LeaderPoseConfig pose_config_;
  TagDetector detector_;
  RejectionCounters rejected_;
};

}  // namespace pilotfish::vision
