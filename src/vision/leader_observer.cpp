#include "pilotfish/vision/leader_observer.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace pilotfish::vision {
namespace {

/// The covariance of (d, theta, psi). With t = cMo's translation, f = cMo's first column (the leader's
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
Eigen::Matrix3d relative_pose_covariance(const Eigen::Isometry3d& bMc, const LeaderPose& pose) {
  const auto cross = [](const Eigen::Vector3d& a) {
    Eigen::Matrix3d matrix;
    matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return matrix;
  };
  const Eigen::Vector3d t = pose.cMo.translation(), f = pose.cMo.linear().col(0);
  Eigen::Matrix<double, 3, 6> dp, dg;
  dp << bMc.linear(), -bMc.linear() * cross(t);
  dg << Eigen::Matrix3d::Zero(), -bMc.linear() * cross(f);

  const Eigen::Vector3d p = bMc * t, g = bMc.linear() * f;
  const double d2 = p.head<2>().squaredNorm(), g2 = g.head<2>().squaredNorm();
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian.row(0) = (p.x() * dp.row(0) + p.y() * dp.row(1)) / std::sqrt(d2);
  jacobian.row(1) = (p.x() * dp.row(1) - p.y() * dp.row(0)) / d2;
  jacobian.row(2) = (g.x() * dg.row(1) - g.y() * dg.row(0)) / g2;
  return jacobian * pose.covariance * jacobian.transpose();
}

bool is_finite(const Observation& o) {
  return std::isfinite(o.distance_m) && std::isfinite(o.bearing_rad) && std::isfinite(o.heading_rad) &&
         o.covariance.allFinite() && o.cMo.matrix().allFinite() && std::isfinite(o.reprojection_error_px) &&
         std::isfinite(o.ambiguity_ratio) && std::isfinite(o.min_decision_margin);
}

/// Takes out every tag whose id occurs more than once; returns how many. `tags` are sorted by id.
int remove_duplicates(std::vector<TagSighting>& tags) {
  std::vector<TagSighting> unique;
  for (auto first = tags.begin(); first != tags.end();) {
    const auto last = std::find_if(first, tags.end(), [&](const TagSighting& tag) { return tag.id != first->id; });
    if (last - first == 1) unique.push_back(*first);
    first = last;
  }
  const auto removed = static_cast<int>(tags.size() - unique.size());
  tags = std::move(unique);
  return removed;
}

void require_ids_of_family(const LeaderBody& body, int family_size) {
  for (std::size_t i = 0; i < body.tags.size(); ++i)
    if (body.tags[i].id >= family_size)
      throw ConfigError("leader.tags[" + std::to_string(i) + "].id", std::to_string(body.tags[i].id) + " is not in " +
                                                                         body.family + ", whose ids are 0 to " +
                                                                         std::to_string(family_size - 1));
}

}  // namespace

LeaderObserver::LeaderObserver(const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body,
                               const LeaderObserverConfig& config)
    : camera_(camera),
      bMc_(base_from_camera(mounting)),
      body_(body),
      pose_config_(config.pose),
      detector_(body.family, config.detector) {
  camera.validate();
  check_ranges(mounting, "camera.mounting");
  body.validate();
  require_ids_of_family(body, detector_.family_size());
  check_ranges(config.pose, "vision");
}

Sight LeaderObserver::observe(const Frame& frame) noexcept {
  try {
    return look(frame);
  } catch (...) {  // only memory can run out here
    ++rejected_.frames_invalid;
    return {std::nullopt, Reason::frame_too_large};
  }
}

Sight LeaderObserver::look(const Frame& frame) {
  const Reason defect = check(frame.image);
  const bool calibrated = frame.image.width == camera_.width && frame.image.height == camera_.height;
  if (defect != Reason::none || !calibrated) {
    ++rejected_.frames_invalid;
    return {std::nullopt, defect != Reason::none ? defect : Reason::frame_size_not_calibrated};
  }
  Detections detections = detector_.detect(frame.image);
  if (detections.input != Reason::none) {
    ++rejected_.frames_invalid;
    return {std::nullopt, detections.input};
  }
  const TagsOfLeader leader = keep_tags_of_leader(std::move(detections));
  if (leader.tags.empty()) return {std::nullopt, leader.reason_if_empty};

  const std::optional<LeaderPose> pose = estimate_leader_pose(camera_, body_, leader.tags, pose_config_);
  if (pose && is_credible(*pose, body_, leader.tags, pose_config_)) {
    const RelativePose relative = relative_pose(bMc_ * pose->cMo);
    Observation observation;
    observation.utime = frame.utime;
    observation.distance_m = relative.distance_m;
    observation.bearing_rad = relative.bearing_rad;
    observation.heading_rad = relative.heading_rad;
    observation.covariance = relative_pose_covariance(bMc_, *pose);
    observation.cMo = pose->cMo;
    observation.reprojection_error_px = pose->reprojection_error_px;
    observation.ambiguity_ratio = pose->ambiguity_ratio;
    observation.min_decision_margin =
        std::min_element(leader.tags.begin(), leader.tags.end(), [](const TagSighting& a, const TagSighting& b) {
          return a.decision_margin < b.decision_margin;
        })->decision_margin;
    observation.tags = leader.tags;
    if (is_finite(observation)) return {observation, Reason::none};
  }
  ++rejected_.pose;
  return {std::nullopt, Reason::pose_refused};
}

LeaderObserver::TagsOfLeader LeaderObserver::keep_tags_of_leader(Detections detections) {
  rejected_.hamming += detections.refused_hamming;
  rejected_.margin += detections.refused_margin;
  TagsOfLeader leader;
  for (TagSighting& tag : detections.tags) {
    if (body_.find(tag.id) != nullptr)
      leader.tags.push_back(std::move(tag));
    else
      ++rejected_.foreign_id;
  }
  const bool only_foreign = leader.tags.empty() && !detections.tags.empty();
  const int duplicates = remove_duplicates(leader.tags);
  rejected_.duplicate_id += duplicates;
  const bool leader_refused =
      duplicates > 0 || std::any_of(detections.refused_ids.begin(), detections.refused_ids.end(),
                                    [this](int id) { return body_.find(id) != nullptr; });
  leader.reason_if_empty = leader_refused ? Reason::tag_refused
                           : only_foreign ? Reason::no_tag_of_the_leader
                                          : Reason::no_tag_found;
  return leader;
}

}  // namespace pilotfish::vision
