#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/refused_value.hpp"
#include "pilotfish/core/se3.hpp"
#include "pilotfish/vision/tag_registration.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// How a leader can move from frame to frame.
struct LeaderTrackConfig {
  static constexpr const char* kText = "How a leader can move from frame to frame.";
  PILOTFISH_PARAMETERS(LeaderTrackConfig);
  PILOTFISH_PARAMETER(
      double, memory_s, 0.5, 0.0, 5.0,
      "for this time after the last measurement the leader is searched for at its prediction; then in the whole frame");
  /// Along and across the line of sight.
  PILOTFISH_PARAMETER(double, max_relative_speed_mps, 4.0, 0.1, 100.0,
                      "a leader that moved faster than that, relative to the coordinator, jumped and is refused");
  PILOTFISH_PARAMETER(double, max_turn_rate_radps, 4.0, 0.1, 100.0,
                      "the same for the sideways sweep when the coordinator turns");
};

/// The leader's last pose and motion relative to the camera, and its prediction. A value.
class LeaderTrack {
 public:
  explicit LeaderTrack(const LeaderTrackConfig& config) : config_(config) {}  ///< no leader known yet

  /// cMo at that time if the leader was seen within memory_s before; it is extrapolated from the last two
  /// frames.
  std::optional<Eigen::Isometry3d> predict(std::int64_t utime) const noexcept;
  /// How far it has jumped, if the leader cannot be there now, given where it was. The plausible region grows with
  /// time, so that a leader that really was carried away is accepted again.
  RefusedValue implausible_jump(const RelativePose& pose, std::int64_t utime) const noexcept;
  double seconds_since(std::int64_t utime) const noexcept;    ///< 0 if it was never seen
  bool is_known() const { return seen_; }                     ///< seen before, and not forgotten
  const Eigen::Isometry3d& last_cMo() const { return cMo_; }  ///< when it was last seen

  /// The leader was measured: its pose, and the appearance of its template.
  void update(const Eigen::Isometry3d& cMo, const RelativePose& pose, const Appearance& appearance,
              std::int64_t utime) noexcept;
  void forget() noexcept { seen_ = false; }  ///< no leader is known any more

  const Appearance& appearance() const { return appearance_; }  ///< of the tags when last seen

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.seen_, self.moving_, self.utime_, self.cMo_, self.twist_, self.pose_, self.appearance_);
  }

 private:
  LeaderTrackConfig config_;
  bool seen_ = false, moving_ = false;
  std::int64_t utime_ = 0;
  Eigen::Isometry3d cMo_ = Eigen::Isometry3d::Identity();
  Vector6d twist_ = Vector6d::Zero();  ///< per second, in the camera frame
  RelativePose pose_;
  Appearance appearance_;
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
