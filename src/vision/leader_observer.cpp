#include "pilotfish/vision/leader_observer.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "pilotfish/core/sections.hpp"
#include "search_region.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kSearch_px = 40.0;    ///< how far from its predicted place a tag is looked for, at most,
constexpr double kSearch_cells = 4.0;  ///< and at most so many of its cells: beyond, a detection is cheaper and surer
constexpr double kMinFacing = 0.2;     ///< cosine of the angle under which a tag is still worth looking at

/// d, theta, psi and their covariance. With t = cMo's translation, f = cMo's first column (the leader's
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
RelativeMeasurement relative_measurement(const Eigen::Isometry3d& bMc, const PoseSolution& pose) {
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
  return {relative_pose(bMc * pose.cMo), jacobian * pose.covariance * jacobian.transpose()};
}

bool is_finite(const RelativeMeasurement& m) {
  return std::isfinite(m.pose.distance_m) && std::isfinite(m.pose.bearing_rad) && std::isfinite(m.pose.heading_rad) &&
         m.covariance.allFinite();
}

/// Field by field, with every counter of two.
template <class Combine>
RejectionCounters combined(const RejectionCounters& a, const RejectionCounters& b, Combine combine) {
  RejectionCounters result;
  for (const RejectionCounters::Named& each : RejectionCounters::all())
    result.*each.count = combine(a.*each.count, b.*each.count);
  return result;
}

RejectionCounters sum_of(const RejectionCounters& a, const RejectionCounters& b) {
  return combined(a, b, [](std::int64_t x, std::int64_t y) { return x + y; });
}

RejectionCounters larger_of_each(const RejectionCounters& a, const RejectionCounters& b) {
  return combined(a, b, [](std::int64_t x, std::int64_t y) { return std::max(x, y); });
}

/// Whether that id occurs once. `tags` are sorted by id.
bool is_unique(const std::vector<TagDetection>& tags, int id) {
  return std::count_if(tags.begin(), tags.end(), [id](const TagDetection& tag) { return tag.id == id; }) == 1;
}

void require_ids_of_family(const LeaderBody& body, int family_size) {
  for (std::size_t i = 0; i < body.tags.size(); ++i)
    if (body.tags[i].id >= family_size)
      throw ConfigError("leader.tags[" + std::to_string(i) + "].id", std::to_string(body.tags[i].id) + " is not in " +
                                                                         body.family + ", whose ids are 0 to " +
                                                                         std::to_string(family_size - 1));
}

std::vector<TagPattern> patterns_of(const LeaderBody& body) {
  const TagFamily family(body.family);
  require_ids_of_family(body, family.size());
  std::vector<TagPattern> patterns;
  for (const BodyTag& tag : body.tags) patterns.push_back(make_pattern(family, tag.id));
  return patterns;
}

/// Side of a cell of the smallest tag at that distance, seen squarely.
double smallest_cell_px(const CameraModel& camera, const LeaderBody& body, const std::vector<TagPattern>& patterns,
                        double distance_m) {
  double smallest_m = body.tags.front().size_m;
  for (const BodyTag& tag : body.tags) smallest_m = std::min(smallest_m, tag.size_m);
  return 0.5 * patterns.front().cell_side * smallest_m * std::sqrt(camera.fx * camera.fy) / distance_m;
}

/// How a refusal is counted and named.
void note(TagRefusal refusal, RejectionCounters& rejected, Reason& reason) {
  switch (refusal) {
    case TagRefusal::not_found: return;  // something stands before it, or it was never there
    case TagRefusal::outside_frame: ++rejected.outside_frame, reason = Reason::tag_outside_frame; return;
    case TagRefusal::too_small: ++rejected.too_small, reason = Reason::tag_too_small; return;
    case TagRefusal::too_blurred: ++rejected.too_blurred, reason = Reason::tag_too_blurred; return;
    case TagRefusal::hamming: ++rejected.hamming, reason = Reason::tag_refused; return;
    case TagRefusal::margin: ++rejected.margin, reason = Reason::tag_refused; return;
    case TagRefusal::residual: ++rejected.residual, reason = Reason::tag_refused; return;
  }
}

void note(Reason refusal, RejectionCounters& rejected) {
  switch (refusal) {
    case Reason::tag_size_implausible: ++rejected.size; return;
    case Reason::leader_behind_camera: ++rejected.behind; return;
    case Reason::leader_jumped: ++rejected.jump; return;
    default: ++rejected.pose; return;
  }
}

}  // namespace

const std::array<RejectionCounters::Named, 13>& RejectionCounters::all() noexcept {
  using C = RejectionCounters;
  static const std::array<Named, 13> table = {{{"frames_invalid", &C::frames_invalid},
                                               {"tag_hamming", &C::hamming},
                                               {"tag_margin", &C::margin},
                                               {"tag_residual", &C::residual},
                                               {"tag_foreign_id", &C::foreign_id},
                                               {"tag_duplicate_id", &C::duplicate_id},
                                               {"tag_outside_frame", &C::outside_frame},
                                               {"tag_too_small", &C::too_small},
                                               {"tag_too_blurred", &C::too_blurred},
                                               {"tag_size", &C::size},
                                               {"pose_behind", &C::behind},
                                               {"pose_jump", &C::jump},
                                               {"pose", &C::pose}}};
  return table;
}

LeaderObserver::LeaderObserver(const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body,
                               const LeaderObserverConfig& config)
    : camera_(camera),
      bMc_(base_from_camera(mounting)),
      body_(body),
      patterns_(patterns_of(body)),
      config_(config),
      detector_(body.family, config.detector),
      track_(config.track),
      heading_(config.heading) {
  camera.validate();
  check_ranges(mounting, "camera.mounting");
  body.validate();
  check_tree(config, "vision");
  decimation_ = config.detector.decimation > 0.0
                    ? config.detector.decimation
                    : decimation_for(smallest_cell_px(camera, body, patterns_, config.acquisition_range_m));
}

void LeaderObserver::forget() noexcept {
  track_.forget();
  heading_.forget();
}

ObservationResult LeaderObserver::observe(const Frame& frame) noexcept { return try_to_look(frame, nullptr); }

ObservationResult LeaderObserver::observe_detected(const Frame& frame, const Detections& found) noexcept {
  return try_to_look(frame, &found);
}

ObservationResult LeaderObserver::try_to_look(const Frame& frame, const Detections* found) noexcept {
  try {
    return look(frame, found);
  } catch (...) {  // only memory can run out here
    ++rejected_.frames_invalid;
    return {std::nullopt, Reason::frame_too_large};
  }
}

ObservationResult LeaderObserver::look(const Frame& frame, const Detections* found) {
  const ImageView& image = frame.image;
  const Reason defect = check(image);
  const bool calibrated = image.width == camera_.width && image.height == camera_.height;
  if (defect != Reason::none || !calibrated) {
    ++rejected_.frames_invalid;
    // A picture of another size need not have been decoded at all; that its pixels are missing is not what is wrong.
    const bool only_size = defect == Reason::none || (defect == Reason::frame_truncated && !calibrated);
    return {std::nullopt, only_size ? Reason::frame_size_not_calibrated : defect};
  }
  const std::optional<Eigen::Isometry3d> predicted = track_.predict(frame.utime);
  Attempt followed;
  if (predicted) {
    followed = follow_tags(image, *predicted);
    ObservationResult sight = conclude(frame, followed, FoundBy::track, predicted);
    if (sight.observation) return sight;
    const double cell_side = patterns_.front().cell_side;
    if (const std::optional<SearchRegion> region =
            region_around(camera_, body_, *predicted, cell_side, 2.0 * kSearch_px)) {
      Attempt detected = detect_tags(image, *region, decimation_for(region->cell_px));
      sight = conclude(frame, detected, FoundBy::region, predicted);
      if (sight.observation) return sight;
    }
  }
  Attempt detected;
  if (found != nullptr) {
    detected = verify_tags(image, *found, Eigen::Vector2d::Zero());
  } else {
    ++whole_picture_searches_;
    const double decimation = frame.coarse_search ? coarser_decimation(decimation_) : decimation_;
    detected = detect_tags(image, {0, 0, image.width, image.height, 0.0}, decimation);
  }
  detected.rejected = larger_of_each(detected.rejected, followed.rejected);
  // What was followed up to the rim of the picture is too near to it for the detector: the first reason is the better
  // one.
  if (detected.reason == Reason::no_tag_found) detected.reason = followed.reason;
  return conclude(frame, detected, FoundBy::frame, std::nullopt);
}

LeaderObserver::Attempt LeaderObserver::follow_tags(const ImageView& image,
                                                    const Eigen::Isometry3d& predicted_cMo) const {
  Attempt attempt;
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    const Eigen::Isometry3d cMt = predicted_cMo * body_from_tag(body_.tags[i]);
    const Eigen::Vector3d middle_c = cMt.translation();
    // Only tags that are in front of the camera and turned towards it can be seen.
    if (!(middle_c.z() > 0.0) || cMt.linear().col(2).dot(middle_c.normalized()) < kMinFacing) continue;
    const double cell_px = 0.5 * patterns_[i].cell_side * body_.tags[i].size_m * camera_.fx / middle_c.z();
    attempt.add(track_tag(image, camera_, patterns_[i], homography_from_pose(cMt, body_.tags[i].size_m),
                          track_.appearance(), std::min(kSearch_px, kSearch_cells * cell_px), bit_gates(),
                          config_.gates));
  }
  return attempt;
}

LeaderObserver::Attempt LeaderObserver::detect_tags(const ImageView& image, const SearchRegion& region,
                                                    double decimation) {
  return verify_tags(image, detector_.detect(part_of(image, region), decimation),
                     Eigen::Vector2d(region.left, region.top));
}

LeaderObserver::Attempt LeaderObserver::verify_tags(const ImageView& image, const Detections& detections,
                                                    const Eigen::Vector2d& origin_px) const {
  Attempt attempt;
  attempt.reason = detections.input;
  if (detections.input != Reason::none) {
    ++attempt.rejected.frames_invalid;
    return attempt;
  }
  attempt.reason = Reason::no_tag_found;
  attempt.rejected.hamming += detections.refused_hamming;
  attempt.rejected.margin += detections.refused_margin;
  for (int id : detections.refused_ids)
    if (body_.find(id) != nullptr) attempt.reason = Reason::tag_refused;

  for (const TagDetection& tag : detections.tags) {
    const auto on_body = std::find_if(patterns_.begin(), patterns_.end(),
                                      [&](const TagPattern& pattern) { return pattern.id == tag.id; });
    if (on_body == patterns_.end()) {
      ++attempt.rejected.foreign_id;
      if (attempt.reason == Reason::no_tag_found) attempt.reason = Reason::no_tag_of_the_leader;
    } else if (!is_unique(detections.tags, tag.id)) {
      ++attempt.rejected.duplicate_id;
      attempt.reason = Reason::tag_duplicate;
    } else {
      std::array<Eigen::Vector2d, 4> corners_px;
      for (int i = 0; i < 4; ++i) corners_px[i] = tag.corners_px[i] + origin_px;
      attempt.add(track_tag(image, camera_, *on_body, homography_from_corners(camera_, corners_px), {}, 0.0,
                            bit_gates(), config_.gates));
    }
  }
  return attempt;
}

void LeaderObserver::Attempt::add(const TagResult& look) {
  if (look.measurement)
    tags.push_back(*look.measurement);
  else
    note(look.refusal, rejected, reason);
}

BitGates LeaderObserver::bit_gates() const {
  return {config_.detector.max_hamming, config_.detector.min_decision_margin};
}

ObservationResult LeaderObserver::conclude(const Frame& frame, Attempt& attempt, FoundBy found_by,
                                           const std::optional<Eigen::Isometry3d>& predicted_cMo) {
  ObservationResult sight{std::nullopt, attempt.reason};
  if (!attempt.tags.empty()) {
    sight = measure(frame, attempt.tags, found_by, predicted_cMo);
    if (!sight.observation) note(sight.reason, attempt.rejected);
    attempt.reason = sight.reason;
  }
  // A frame is concluded by its last attempt; what an earlier one refused, a later one may have accepted.
  if (sight.observation || found_by == FoundBy::frame) rejected_ = sum_of(rejected_, attempt.rejected);
  return sight;
}

ObservationResult LeaderObserver::measure(const Frame& frame, const TagMeasurements& tags, FoundBy found_by,
                                          const std::optional<Eigen::Isometry3d>& predicted_cMo) {
  const std::optional<LeaderPose> pose = estimate_leader_pose(camera_, body_, tags, config_.pose, predicted_cMo);
  if (!pose) return {std::nullopt, Reason::pose_refused};
  const Reason defect = check_pose(pose->best, body_, tags, config_.pose);
  if (defect != Reason::none) return {std::nullopt, defect};

  BoundedVector<PoseSolution, 2> solutions;
  BoundedVector<HeadingCandidate, 2> candidates;
  const auto offer = [&](const PoseSolution& solution) {
    solutions.push_back(solution);
    candidates.push_back({relative_measurement(bMc_, solution), solution.squared_error});
  };
  offer(pose->best);
  if (pose->other && check_pose(*pose->other, body_, tags, config_.pose) == Reason::none) offer(*pose->other);
  for (const HeadingCandidate& candidate : candidates)
    if (!is_finite(candidate.measurement)) return {std::nullopt, Reason::pose_refused};
  if (!track_.is_plausible(candidates.front().measurement.pose, frame.utime))
    return {std::nullopt, Reason::leader_jumped};

  HeadingFilter heading = heading_;
  const double dt_s = std::max(0.0, track_.seconds_since(frame.utime));  // a clock that was set back is no motion
  if (dt_s > config_.heading.memory_s) heading.forget();
  const int degrees_of_freedom = 8 * static_cast<int>(tags.size()) - 6;
  const FilteredHeading filtered = heading.update(candidates, degrees_of_freedom, dt_s);
  if (!is_finite(filtered.fused)) return {std::nullopt, Reason::pose_refused};
  const PoseSolution& accepted = solutions[filtered.candidate];

  Observation observation;
  observation.utime = frame.utime;
  observation.distance_m = filtered.fused.pose.distance_m;
  observation.bearing_rad = filtered.fused.pose.bearing_rad;
  observation.heading_rad = filtered.fused.pose.heading_rad;
  observation.covariance = filtered.fused.covariance;
  observation.measured = candidates[filtered.candidate].measurement;
  observation.heading_ambiguity = filtered.ambiguity;
  observation.cMo = accepted.cMo;
  if (solutions.size() == 2) observation.other_cMo = solutions[1 - filtered.candidate].cMo;
  observation.ambiguity_ratio = pose->ambiguity_ratio;
  observation.reprojection_error_px = accepted.reprojection_error_px;
  observation.found_by = found_by;
  observation.min_decision_margin = tags.front().tag.decision_margin;
  for (const TagMeasurement& measurement : tags) {
    observation.tags.push_back(measurement.tag);
    observation.min_decision_margin = std::min(observation.min_decision_margin, measurement.tag.decision_margin);
  }
  heading_ = heading;
  track_.update(accepted.cMo, observation.measured.pose, tags.front().appearance, frame.utime);
  return {observation, Reason::none};
}

}  // namespace pilotfish::vision
