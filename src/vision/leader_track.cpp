#include "pilotfish/vision/leader_track.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/utime.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kTwistFrom_s = 0.2;  ///< two measurements farther apart do not give the present motion
constexpr double kSlack_m = 0.1;      ///< measurement errors are no jumps
constexpr double kMaxTurn_rad = 0.5;  ///< a faster turn between two frames was the other planar solution

}  // namespace

double LeaderTrack::seconds_since(std::int64_t utime) const noexcept {
  return seen_ ? seconds_between(utime_, utime) : 0.0;
}

std::optional<Eigen::Isometry3d> LeaderTrack::predict(std::int64_t utime) const noexcept {
  const double dt_s = seconds_since(utime);
  if (!seen_ || dt_s < 0.0 || dt_s > config_.memory_s) return std::nullopt;
  if (!moving_ || dt_s > kTwistFrom_s) return cMo_;
  return se3::exp(dt_s * twist_) * cMo_;
}

RefusedValue LeaderTrack::implausible_jump(const RelativePose& pose, std::int64_t utime) const noexcept {
  if (!seen_) return {};
  const double dt_s = std::max(0.0, seconds_since(utime));
  const double reach_m = config_.max_relative_speed_mps * dt_s + kSlack_m;
  const double across_m =
      std::abs(wrap_angle(pose.bearing_rad - pose_.bearing_rad)) * std::min(pose.distance_m, pose_.distance_m);
  const double along_m = std::abs(pose.distance_m - pose_.distance_m);
  if (!(along_m <= reach_m)) return at_most("jump along the line of sight", along_m, reach_m, "m");
  const double reach_across_m = reach_m + config_.max_turn_rate_radps * dt_s * pose_.distance_m;
  if (!(across_m <= reach_across_m)) return at_most("jump across the line of sight", across_m, reach_across_m, "m");
  return {};
}

void LeaderTrack::update(const Eigen::Isometry3d& cMo, const RelativePose& pose, const Appearance& appearance,
                         std::int64_t utime) noexcept {
  const double dt_s = seconds_since(utime);
  moving_ = false;
  if (seen_ && dt_s > 0.0 && dt_s < kTwistFrom_s) {
    const Vector6d motion = se3::log(cMo * cMo_.inverse());
    if (motion.tail<3>().norm() < kMaxTurn_rad) {
      twist_ = motion / dt_s;
      moving_ = true;
    }
  }
  seen_ = true;
  utime_ = utime;
  cMo_ = cMo;
  pose_ = pose;
  appearance_ = appearance;
}

}  // namespace pilotfish::vision
