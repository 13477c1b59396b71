#include "pilotfish/vision/leader_pose.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/vision/homography.hpp"
#include "planar_pose.hpp"
#include "tag_warp.hpp"
#include "virtual_visual_servoing.hpp"

namespace pilotfish::vision {
namespace {

/// Two minima nearer than this are one: such a small difference in heading has no effect.
constexpr double kSameRotation_rad = radians(3.0);
/// An error below is rounding, not measurement; it also prevents a division by zero. In squared standard deviations.
constexpr double kErrorFloor = 1e-6;

/// Nothing if the camera model cannot be inverted there, as outside the circle in which a fitted distortion holds.
std::optional<SquareSighting> undistorted(const CameraModel& camera, const BodyTag& on_body,
                                          const TagMeasurement& measurement, double corner_sigma_px) {
  SquareSighting square;
  square.corners_o = corners_on_body(on_body);
  Eigen::Matrix<double, 8, 8> pixels_by_normalized = Eigen::Matrix<double, 8, 8>::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Vector2d& pixel = measurement.tag.corners_px[i];
    square.normalized[i] = normalize_pixel(camera, pixel);
    if (!((project_normalized(camera, square.normalized[i]) - pixel).norm() < 1e-6)) return std::nullopt;
    pixels_by_normalized.block<2, 2>(2 * i, 2 * i) = pixels_from_normalized(camera, square.normalized[i]);
  }
  Matrix8d covariance = measurement.covariance_px2;
  covariance.diagonal().array() += corner_sigma_px * corner_sigma_px + 1e-12;
  const Eigen::LLT<Matrix8d> cholesky(covariance);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  square.whitening = cholesky.matrixL().solve(pixels_by_normalized);
  return square;
}

/// With the whole camera model, in the picture as it is. All points are in front of the camera.
double rms_error_px(const CameraModel& camera, const Eigen::Isometry3d& cMo, const SquareSightings& squares,
                    const TagMeasurements& tags) {
  double sum = 0.0;
  for (std::size_t k = 0; k < squares.size(); ++k)
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d point_c = cMo * squares[k].corners_o[i];
      const Eigen::Vector2d seen = project_normalized(camera, point_c.head<2>() / point_c.z());
      sum += (seen - tags[k].tag.corners_px[i]).squaredNorm();
    }
  return std::sqrt(sum / (4.0 * static_cast<double>(squares.size())));
}

std::optional<PoseSolution> solve(const Eigen::Isometry3d& start, const CameraModel& camera,
                                  const SquareSightings& squares, const TagMeasurements& tags) {
  const std::optional<LocalMinimum> minimum = servo_virtually(start, squares);
  if (!minimum) return std::nullopt;
  // The corners' noise reaches the pose as (J^T J)^-1. The step of the virtual camera is minus the twist that acts on
  // cMo: a sign that a covariance does not see.
  const Eigen::LLT<Matrix6d> information(minimum->information);
  if (information.info() != Eigen::Success) return std::nullopt;
  PoseSolution solution{minimum->cMo, information.solve(Matrix6d::Identity()), minimum->squared_error,
                        rms_error_px(camera, minimum->cMo, squares, tags)};
  if (!solution.cMo.matrix().allFinite() || !solution.covariance.allFinite() ||
      !std::isfinite(solution.reprojection_error_px))
    return std::nullopt;
  return solution;
}

bool are_the_same(const PoseSolution& a, const PoseSolution& b) {
  return se3::angle_between(a.cMo, b.cMo) < kSameRotation_rad;
}

}  // namespace

std::optional<LeaderPose> estimate_leader_pose(const CameraModel& camera, const LeaderBody& body,
                                               const TagMeasurements& tags, const LeaderPoseConfig& config,
                                               const std::optional<Eigen::Isometry3d>& guess) noexcept {
  SquareSightings squares;
  const BodyTag* largest = nullptr;
  const TagDetection* largest_seen = nullptr;
  for (const TagMeasurement& measurement : tags) {
    const BodyTag* on_body = body.find(measurement.tag.id);
    if (on_body == nullptr) return std::nullopt;
    const std::optional<SquareSighting> square = undistorted(camera, *on_body, measurement, config.corner_sigma_px);
    if (!square) return std::nullopt;
    squares.push_back(*square);
    if (largest_seen == nullptr ||
        quadrilateral_area(measurement.tag.corners_px) > quadrilateral_area(largest_seen->corners_px)) {
      largest = on_body;
      largest_seen = &measurement.tag;
    }
  }
  if (squares.empty()) return std::nullopt;

  const Eigen::Isometry3d oMt = body_from_tag(*largest);
  std::optional<PoseSolution> first;
  if (guess) first = solve(*guess, camera, squares, tags);
  if (!first) {
    const Eigen::Matrix3d nHt = homography_from_corners(camera, largest_seen->corners_px);
    if (!nHt.allFinite()) return std::nullopt;
    first = solve(pose_from_homography(nHt, largest->size_m) * oMt.inverse(), camera, squares, tags);
  }
  if (!first) return std::nullopt;
  std::optional<PoseSolution> second =
      solve(mirrored_about_line_of_sight(first->cMo * oMt) * oMt.inverse(), camera, squares, tags);
  if (second && are_the_same(*first, *second)) second.reset();
  if (second && second->squared_error < first->squared_error) std::swap(*first, *second);

  LeaderPose pose{*first, second, kMaxAmbiguityRatio};
  if (second)
    pose.ambiguity_ratio = std::min(kMaxAmbiguityRatio, std::sqrt(std::max(second->squared_error, kErrorFloor) /
                                                                  std::max(first->squared_error, kErrorFloor)));
  return pose;
}

PoseVerdict check_pose(const PoseSolution& pose, const LeaderBody& body, const TagMeasurements& tags,
                       const LeaderPoseConfig& config) noexcept {
  for (const TagMeasurement& measurement : tags) {
    const BodyTag* on_body = body.find(measurement.tag.id);
    if (on_body == nullptr) return {Reason::pose_refused, {}};
    const Eigen::Isometry3d cMt = pose.cMo * body_from_tag(*on_body);
    const Eigen::Vector3d middle_c = cMt.translation(), into_wall_c = cMt.linear().col(2);
    const bool printed_side_seen = into_wall_c.dot(middle_c) > 0.0;
    if (!(middle_c.z() > 0.0) || !printed_side_seen) return {Reason::leader_behind_camera, {}};
    const double range_m = middle_c.norm();
    if (!(range_m >= config.min_distance_m && range_m <= config.max_distance_m))
      return {Reason::tag_size_implausible, {"range", "m", range_m, config.min_distance_m, config.max_distance_m}};
  }
  const double error_px = pose.reprojection_error_px;
  if (error_px <= config.max_reprojection_error_px) return {};
  return {Reason::pose_refused, at_most("reprojection error", error_px, config.max_reprojection_error_px, "px")};
}

}  // namespace pilotfish::vision
