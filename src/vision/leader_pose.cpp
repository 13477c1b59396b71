#include "pilotfish/vision/leader_pose.hpp"

#include <algorithm>
#include <array>
#include <opencv2/calib3d.hpp>

#include "pilotfish/core/angles.hpp"
#include "virtual_visual_servoing.hpp"

namespace pilotfish::vision {
namespace {

/// Two minima nearer than this are one: a heading so little different does not matter to anybody.
constexpr double kSameRotation_rad = radians(3.0);
/// Errors below are rounding, not measurement; and nobody divides by zero.
constexpr double kErrorFloor_px = 1e-6;

struct Candidate {
  LocalMinimum minimum;
  double reprojection_error_px = 0.0;
};

/// Nothing if the camera model cannot be inverted there, as outside the circle in which a fitted distortion holds.
std::optional<PointSighting> undistorted(const CameraModel& camera, const Eigen::Vector3d& point_o,
                                         const Eigen::Vector2d& pixel) {
  PointSighting sighting{point_o, pixel, normalize_pixel(camera, pixel), Eigen::Matrix2d::Zero()};
  const double round_trip_px = (project_normalized(camera, sighting.normalized) - pixel).norm();
  if (!(round_trip_px < 1e-6)) return std::nullopt;
  // Central differences: the model is a polynomial of degree 7, so 1e-5 leaves a relative error of about 1e-10.
  const double h = 1e-5;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d offset = h * Eigen::Vector2d::Unit(axis);
    sighting.pixels_from_normalized.col(axis) = (project_normalized(camera, sighting.normalized + offset) -
                                                 project_normalized(camera, sighting.normalized - offset)) /
                                                (2.0 * h);
  }
  return sighting;
}

std::optional<std::vector<PointSighting>> match_corners(const CameraModel& camera, const LeaderBody& body,
                                                        const std::vector<TagSighting>& tags) {
  std::vector<PointSighting> points;
  for (const TagSighting& tag : tags) {
    const BodyTag* on_body = body.find(tag.id);
    if (on_body == nullptr) return std::nullopt;
    const std::array<Eigen::Vector3d, 4> corners_o = corners_on_body(*on_body);
    for (int i = 0; i < 4; ++i) {
      const std::optional<PointSighting> point = undistorted(camera, corners_o[i], tag.corners_px[i]);
      if (!point) return std::nullopt;
      points.push_back(*point);
    }
  }
  return points;
}

/// The pose of a tag that faces the camera squarely, as large and as turned as it looks.
Eigen::Isometry3d frontal_pose(const BodyTag& tag, const PointSighting* corners) {
  const Eigen::Vector2d right =
      (corners[1].normalized - corners[0].normalized + corners[2].normalized - corners[3].normalized) / 2.0;
  const Eigen::Vector2d centre =
      (corners[0].normalized + corners[1].normalized + corners[2].normalized + corners[3].normalized) / 4.0;
  const double depth_m = tag.size_m / right.norm();
  Eigen::Isometry3d cMt = Eigen::Isometry3d::Identity();
  cMt.linear() = Eigen::AngleAxisd(std::atan2(right.y(), right.x()), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  cMt.translation() = depth_m * Eigen::Vector3d(centre.x(), centre.y(), 1.0);
  return cMt;
}

/// Both poses that a plane can have (Collins and Bartoli, "Infinitesimal plane-based pose estimation", 2014),
/// as cMo. `corners` are the tag's four, in AprilTag's order. That is the order IPPE_SQUARE asks for: it
/// reads the same numbers (-h, h), (h, h), (h, -h), (-h, -h) with y up where our tag frame has y down, and only the
/// numbers matter.
std::vector<Eigen::Isometry3d> planar_poses(const BodyTag& tag, const PointSighting* corners) {
  const double h = tag.size_m / 2.0;
  const std::array<cv::Point3d, 4> square = {cv::Point3d(-h, h, 0), {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
  std::array<cv::Point2d, 4> seen;
  for (int i = 0; i < 4; ++i) seen[i] = {corners[i].normalized.x(), corners[i].normalized.y()};
  std::vector<cv::Mat> rotations, translations;
  try {
    cv::solvePnPGeneric(square, seen, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                        cv::SOLVEPNP_IPPE_SQUARE);
  } catch (const cv::Exception&) {
    // Four corners that no square can have: collinear, or on one point. The gates will see to them.
  }
  const Eigen::Isometry3d tMo = body_from_tag(tag).inverse();
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const cv::Vec3d r = rotations[i], t = translations[i];
    const Eigen::Vector3d rotation_vector(r[0], r[1], r[2]);
    const double angle = rotation_vector.norm();
    Eigen::Isometry3d cMt = Eigen::Isometry3d::Identity();
    if (angle > 0.0) cMt.linear() = Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
    cMt.translation() = Eigen::Vector3d(t[0], t[1], t[2]);
    if (cMt.matrix().allFinite()) poses.push_back(cMt * tMo);
  }
  // OpenCV's solution is NaN for a tag that faces the camera exactly squarely, which is our nominal view: the
  // root of a number that rounding made negative.
  if (poses.empty()) poses.push_back(frontal_pose(tag, corners) * tMo);
  return poses;
}

/// With the whole camera model, in the picture as it is. All points are in front of the camera.
double rms_error_px(const CameraModel& camera, const Eigen::Isometry3d& cMo, const std::vector<PointSighting>& points) {
  double sum = 0.0;
  for (const PointSighting& point : points)
    sum += (project(camera, cMo * point.point_o).value() - point.pixel).squaredNorm();
  return std::sqrt(sum / static_cast<double>(points.size()));
}

std::vector<Candidate> local_minima(const CameraModel& camera, const LeaderBody& body,
                                    const std::vector<TagSighting>& tags, const std::vector<PointSighting>& points) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    for (const Eigen::Isometry3d& start : planar_poses(*body.find(tags[i].id), &points[4 * i])) {
      const std::optional<LocalMinimum> minimum = servo_virtually(start, points);
      if (minimum) candidates.push_back({*minimum, rms_error_px(camera, minimum->cMo, points)});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.reprojection_error_px < b.reprojection_error_px;
  });
  return candidates;
}

double ambiguity_ratio(const std::vector<Candidate>& best_first) {
  const Candidate& best = best_first.front();
  for (const Candidate& other : best_first) {
    const Eigen::AngleAxisd turn(best.minimum.cMo.linear().transpose() * other.minimum.cMo.linear());
    if (turn.angle() < kSameRotation_rad) continue;
    const double ratio =
        std::max(other.reprojection_error_px, kErrorFloor_px) / std::max(best.reprojection_error_px, kErrorFloor_px);
    return std::min(ratio, kMaxAmbiguityRatio);
  }
  return kMaxAmbiguityRatio;
}

std::optional<LeaderPose> estimate(const CameraModel& camera, const LeaderBody& body,
                                   const std::vector<TagSighting>& tags, const LeaderPoseConfig& config) {
  const std::optional<std::vector<PointSighting>> points = match_corners(camera, body, tags);
  if (!points) return std::nullopt;
  const std::vector<Candidate> candidates = local_minima(camera, body, tags, *points);
  if (candidates.empty()) return std::nullopt;
  const Candidate& best = candidates.front();

  // Independent noise of sigma on each corner coordinate reaches the pose as sigma^2 (J^T J)^-1. The step of
  // the virtual camera is minus the twist that acts on cMo: a sign that a covariance does not see.
  const Eigen::LLT<Matrix6d> information(best.minimum.information);
  if (information.info() != Eigen::Success) return std::nullopt;
  LeaderPose pose;
  pose.cMo = best.minimum.cMo;
  pose.reprojection_error_px = best.reprojection_error_px;
  pose.ambiguity_ratio = ambiguity_ratio(candidates);
  pose.covariance = config.corner_sigma_px * config.corner_sigma_px * information.solve(Matrix6d::Identity());
  if (!pose.cMo.matrix().allFinite() || !pose.covariance.allFinite() || !std::isfinite(pose.reprojection_error_px))
    return std::nullopt;
  return pose;
}

}  // namespace

const std::vector<Parameter<LeaderPoseConfig>>& LeaderPoseConfig::parameters() {
  static const std::vector<Parameter<LeaderPoseConfig>> table = {
      {"max_reprojection_error_px", &LeaderPoseConfig::max_reprojection_error_px, 0.01, 100.0,
       "RMS distance between seen and projected corners above which a pose is refused"},
      {"corner_sigma_px", &LeaderPoseConfig::corner_sigma_px, 0.001, 10.0,
       "standard deviation of one corner coordinate, from which the covariance is made"},
      {"max_distance_m", &LeaderPoseConfig::max_distance_m, 0.1, 1000.0,
       "camera to tag; a pose farther away is refused"},
  };
  return table;
}

std::optional<LeaderPose> estimate_leader_pose(const CameraModel& camera, const LeaderBody& body,
                                               const std::vector<TagSighting>& tags,
                                               const LeaderPoseConfig& config) noexcept {
  try {
    return estimate(camera, body, tags, config);
  } catch (...) {
    return std::nullopt;
  }
}

bool is_credible(const LeaderPose& pose, const LeaderBody& body, const std::vector<TagSighting>& tags,
                 const LeaderPoseConfig& config) noexcept {
  if (!(pose.reprojection_error_px <= config.max_reprojection_error_px)) return false;
  return std::all_of(tags.begin(), tags.end(), [&](const TagSighting& tag) {
    const BodyTag* on_body = body.find(tag.id);
    if (on_body == nullptr) return false;
    const Eigen::Isometry3d cMt = pose.cMo * body_from_tag(*on_body);
    const Eigen::Vector3d centre_c = cMt.translation(), into_wall_c = cMt.linear().col(2);
    const bool printed_side_seen = into_wall_c.dot(centre_c) > 0.0;
    return centre_c.z() > 0.0 && printed_side_seen && centre_c.norm() <= config.max_distance_m;
  });
}

}  // namespace pilotfish::vision
