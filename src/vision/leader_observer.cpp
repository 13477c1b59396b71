#include "pilotfish/vision/leader_observer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotfish/core/sections.hpp"
#include "pose_candidates.hpp"
#include "rolling_shutter.hpp"
#include "search_region.hpp"
#include "textured_regions.hpp"

// The processing of a frame, from top to bottom: observe_frame() calls the functions below it, in that order.

namespace pilotfish::vision {
namespace {

constexpr std::size_t kMaxForeignIds = 8;
constexpr std::int64_t kFineSearchEvery = 8;  ///< searches without result: a fine one takes three times as long
constexpr double kCoarseDecimation = 2.0;     ///< what it misses, a search of the parts with detail finds

/// With it the smallest tag at that distance, seen squarely, is still found in a search of the whole picture.
double acquisition_decimation(const TagTracker& tracker, double distance_m) {
  const double focal_px = std::sqrt(tracker.camera().fx * tracker.camera().fy);
  double smallest_px = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tracker.body().tags.size(); ++i)
    smallest_px = std::min(smallest_px, tracker.cell_px(i, focal_px, distance_m));
  return decimation_for(smallest_px);
}

Observation observation_of(std::int64_t utime, FoundBy found_by, const TagMeasurements& tags,
                           const PoseCandidates& found, const FilteredHeading& filtered) {
  const PoseSolution& accepted = found.solutions[filtered.candidate];
  Observation observation;
  observation.utime = utime;
  observation.distance_m = filtered.fused.pose.distance_m;
  observation.bearing_rad = filtered.fused.pose.bearing_rad;
  observation.heading_rad = filtered.fused.pose.heading_rad;
  observation.covariance = filtered.fused.covariance;
  observation.measured = found.candidates[filtered.candidate].measurement;
  observation.heading_ambiguity = filtered.ambiguity;
  observation.cMo = accepted.cMo;
  if (found.solutions.size() == 2) observation.other_cMo = found.solutions[1 - filtered.candidate].cMo;
  observation.ambiguity_ratio = found.ambiguity_ratio;
  observation.reprojection_error_px = accepted.reprojection_error_px;
  observation.found_by = found_by;
  observation.min_decision_margin = tags.front().tag.decision_margin;
  for (const TagMeasurement& measurement : tags) {
    observation.tags.push_back(measurement.tag);
    observation.min_decision_margin = std::min(observation.min_decision_margin, measurement.tag.decision_margin);
  }
  return observation;
}

}  // namespace

LeaderObserver::LeaderObserver(const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body,
                               const LeaderObserverConfig& config)
    : tracker_(camera, body, config.detector, config.gates),
      bMc_(base_from_camera(mounting)),
      config_(config),
      detector_(body.family, config.detector),
      track_(config.track),
      heading_(config.heading) {
  check_ranges(mounting, "camera.mounting");
  check_tree(config, "vision");
  decimation_ = config.detector.decimation > 0.0
                    ? config.detector.decimation
                    : std::max(kCoarseDecimation, acquisition_decimation(tracker_, config.acquisition_range_m));
}

void LeaderObserver::forget() noexcept {
  track_.forget();
  heading_.forget();
}

ObservationResult LeaderObserver::observe(const Frame& frame) noexcept { return observe_or_refuse(frame, nullptr); }

ObservationResult LeaderObserver::observe_detected(const Frame& frame, const Detections& found) noexcept {
  return observe_or_refuse(frame, &found);
}

ObservationResult LeaderObserver::observe_or_refuse(const Frame& frame, const Detections* found) noexcept {
  try {
    return observe_frame(frame, found);
  } catch (...) {  // only memory can run out here
    ++rejected_.frames_invalid;
    return {std::nullopt, Reason::frame_too_large, {}};
  }
}

ObservationResult LeaderObserver::observe_frame(const Frame& frame, const Detections* found) {
  const ImageView& image = frame.image;
  searched_.reset();
  const Reason defect = why_unusable(image);
  if (defect != Reason::none) {
    ++rejected_.frames_invalid;
    return {std::nullopt, defect, {}};
  }
  stopwatch_.start();
  Attempt tracked;
  if (const std::optional<Eigen::Isometry3d> predicted_cMo = track_.predict(frame.utime)) {
    tracked = track_tags(image, *predicted_cMo);
    ObservationResult result = conclude(frame, tracked, predicted_cMo);
    if (result.observation) return result;
    const auto region = region_around(tracker_, *predicted_cMo, 2.0 * TagTracker::kSearch_px);
    if (region) {
      Attempt detected = detect_tags(image, *region, decimation_for(region->cell_px), FoundBy::region);
      result = conclude(frame, detected, predicted_cMo);
      if (result.observation) return result;
    }
  }
  Attempt detected;
  if (found != nullptr) {
    detected = track_detections(image, *found, Eigen::Vector2d::Zero(), FoundBy::frame);
  } else {
    ++whole_picture_searches_;
    searched_ = search_whole(image, frame.coarse_search);
    detected = track_detections(image, *searched_, Eigen::Vector2d::Zero(), FoundBy::frame);
    if (detected.tags.empty() && search_finely(image, frame.coarse_search))
      detected = track_detections(image, *searched_, Eigen::Vector2d::Zero(), FoundBy::frame);
  }
  detected.rejected = larger_of_each(detected.rejected, tracked.rejected);
  // A tag tracked up to the edge of the picture is too near to it for the detector: the first reason is the more
  // accurate one.
  if (detected.reason == Reason::no_tag_found) detected.reason = tracked.reason;
  if (detected.reason == tracked.reason && !detected.refused) detected.refused = tracked.refused;
  return conclude(frame, detected, std::nullopt);
}

Reason LeaderObserver::why_unusable(const ImageView& image) const {
  const Reason defect = check(image);
  const bool calibrated = image.width == tracker_.camera().width && image.height == tracker_.camera().height;
  if (calibrated) return defect;
  // A picture of another size need not have been decoded at all; the fault is then not that its pixels are missing.
  const bool only_size = defect == Reason::none || defect == Reason::frame_truncated;
  return only_size ? Reason::frame_size_not_calibrated : defect;
}

LeaderObserver::Attempt LeaderObserver::track_tags(const ImageView& image, const Eigen::Isometry3d& predicted_cMo) {
  Attempt attempt;
  attempt.found_by = FoundBy::track;
  for (std::size_t i = 0; i < tracker_.body().tags.size(); ++i) {
    const std::optional<TagPrediction> prediction = tracker_.predict(i, predicted_cMo);
    stopwatch_.lap(Stage::predict);
    if (prediction) attempt.add(tracker_.track(image, *prediction, track_.appearance(), &stopwatch_));
  }
  return attempt;
}

LeaderObserver::Attempt LeaderObserver::detect_tags(const ImageView& image, const SearchRegion& region,
                                                    double decimation, FoundBy found_by) {
  const Detections detections = detector_.detect(part_of(image, region), decimation);
  stopwatch_.lap(Stage::detect);
  return track_detections(image, detections, Eigen::Vector2d(region.left, region.top), found_by);
}

/// Near tags in the whole picture, shrunk; far ones at full resolution where the picture is full of detail. So the time
/// is that of the coarse search, and the range that of the fine one.
Detections LeaderObserver::search_whole(const ImageView& image, bool coarse) {
  const bool chosen = config_.detector.decimation > 0.0;
  Detections found = detector_.detect(image, coarse ? coarser_decimation(decimation_) : decimation_);
  if (!chosen && !coarse && found.input == Reason::none)
    for (const SearchRegion& region : textured_regions(image, static_cast<int>(config_.detector.min_decision_margin)))
      found.merge(detector_.detect(part_of(image, region), 1.0), Eigen::Vector2d(region.left, region.top));
  stopwatch_.lap(Stage::detect);
  return found;
}

/// A near tag that a highlight or a narrow ring disturbs is found at full resolution alone, and has not the detail by
/// which a far one is found. So the whole picture is searched at full resolution too, at once after the leader was lost
/// and then now and then. False if it was not.
bool LeaderObserver::search_finely(const ImageView& image, bool coarse) {
  if (coarse || config_.detector.decimation > 0.0 || searched_->input != Reason::none) return false;
  if (fruitless_searches_++ % kFineSearchEvery != 0) return false;
  searched_->merge(detector_.detect(image, 1.0), Eigen::Vector2d::Zero());
  stopwatch_.lap(Stage::detect);
  return true;
}

LeaderObserver::Attempt LeaderObserver::track_detections(const ImageView& image, const Detections& detections,
                                                         const Eigen::Vector2d& origin_px, FoundBy found_by) {
  Attempt attempt;
  attempt.found_by = found_by;
  if (detections.input != Reason::none) {
    attempt.reason = detections.input;
    ++attempt.rejected.frames_invalid;
    return attempt;
  }
  if (found_by == FoundBy::frame) foreign_ids_.clear();
  attempt.rejected.hamming += detections.refused_hamming;
  attempt.rejected.margin += detections.refused_margin;
  for (int id : detections.refused_ids)
    if (tracker_.find(id)) attempt.reason = Reason::tag_refused;

  for (const TagDetection& tag : detections.tags) {
    const std::optional<std::size_t> on_body = tracker_.find(tag.id);
    if (!on_body) {
      ++attempt.rejected.foreign_id;
      if (found_by == FoundBy::frame) note_foreign(tag.id);
      if (attempt.reason == Reason::no_tag_found) attempt.reason = Reason::no_tag_of_the_leader;
    } else if (!detections.is_unique(tag.id)) {
      ++attempt.rejected.duplicate_id;
      attempt.reason = Reason::tag_duplicate;
    } else {
      std::array<Eigen::Vector2d, 4> corners_px;
      for (std::size_t i = 0; i < corners_px.size(); ++i) corners_px[i] = tag.corners_px[i] + origin_px;
      const TagPrediction prediction = tracker_.predict(*on_body, corners_px);
      stopwatch_.lap(Stage::predict);
      attempt.add(tracker_.track(image, prediction, {}, &stopwatch_));
    }
  }
  if (attempt.tags.empty()) track_unsure(image, detections, origin_px, attempt);
  return attempt;
}

/// libapriltag reads with one threshold; what a highlight hides from it, a reading with the levels around each cell may
/// show. What it says is no more than a place where to look: the gates are the same. Of an id that is there twice,
/// neither is used.
void LeaderObserver::track_unsure(const ImageView& image, const Detections& detections,
                                  const Eigen::Vector2d& origin_px, Attempt& attempt) {
  const auto has_id = [](const std::vector<TagDetection>& tags, int id) {
    return std::count_if(tags.begin(), tags.end(), [id](const TagDetection& tag) { return tag.id == id; });
  };
  for (const TagDetection& tag : detections.unsure) {
    const std::optional<std::size_t> on_body = tracker_.find(tag.id);
    if (!on_body || has_id(detections.unsure, tag.id) != 1 || has_id(detections.tags, tag.id) != 0) continue;
    std::array<Eigen::Vector2d, 4> corners_px;
    for (std::size_t i = 0; i < corners_px.size(); ++i) corners_px[i] = tag.corners_px[i] + origin_px;
    const TagOutcome<TagMeasurement> outcome =
        tracker_.track(image, tracker_.predict(*on_body, corners_px), {}, &stopwatch_);
    if (!outcome) continue;  // refused once already
    attempt.add(outcome);
    --attempt.rejected.hamming;
  }
}

void LeaderObserver::note_foreign(int id) {
  const bool known = std::find(foreign_ids_.begin(), foreign_ids_.end(), id) != foreign_ids_.end();
  if (!known && foreign_ids_.size() < kMaxForeignIds) foreign_ids_.push_back(id);
}

void LeaderObserver::Attempt::add(const TagOutcome<TagMeasurement>& outcome) {
  if (outcome) {
    tags.push_back(*outcome);
  } else if (outcome.refusal != TagRefusal::not_found) {
    reason = rejected.count(outcome.refusal, reason);
    refused = outcome.refused;
  }
}

/// Counts what the attempt refused, if it is the frame's last attempt.
ObservationResult LeaderObserver::conclude(const Frame& frame, Attempt& attempt,
                                           const std::optional<Eigen::Isometry3d>& predicted_cMo) {
  ObservationResult result{std::nullopt, attempt.reason, attempt.refused};
  if (!attempt.tags.empty()) {
    result = measure(frame, attempt, predicted_cMo);
    if (!result.observation) attempt.rejected.count_pose(result.reason);
    attempt.reason = result.reason;
    attempt.refused = result.refused;
  }
  // A frame is concluded by its last attempt; what an earlier one refused, a later one may have accepted.
  if (result.observation || attempt.found_by == FoundBy::frame) rejected_ = sum_of(rejected_, attempt.rejected);
  return result;
}

ObservationResult LeaderObserver::measure(const Frame& frame, const Attempt& attempt,
                                          const std::optional<Eigen::Isometry3d>& predicted_cMo) {
  std::optional<Before> before;
  if (track_.is_known()) before = Before{track_.last_cMo(), track_.seconds_since(frame.utime)};
  const TagMeasurements tags = at_one_instant(tracker_.camera(), tracker_.body(), attempt.tags, before);
  const PoseCandidates found =
      pose_candidates(tracker_.camera(), tracker_.body(), bMc_, tags, config_.pose, predicted_cMo);
  stopwatch_.lap(Stage::pose);
  if (found.verdict.reason != Reason::none) return {std::nullopt, found.verdict.reason, found.verdict.refused};
  if (const RefusedValue jump = track_.implausible_jump(found.candidates.front().measurement.pose, frame.utime))
    return {std::nullopt, Reason::leader_jumped, jump};

  HeadingFilter heading = heading_;
  const double dt_s = std::max(0.0, track_.seconds_since(frame.utime));  // a clock that was set back is no motion
  if (dt_s > config_.heading.memory_s) heading.forget();
  const int degrees_of_freedom = 8 * static_cast<int>(attempt.tags.size()) - 6;
  const FilteredHeading filtered = heading.update(found.candidates, degrees_of_freedom, dt_s);
  stopwatch_.lap(Stage::heading);
  if (!is_finite(filtered.fused)) return {std::nullopt, Reason::pose_refused, {}};

  // Accepted: state changes only here.
  fruitless_searches_ = 0;
  const Observation observation = observation_of(frame.utime, attempt.found_by, attempt.tags, found, filtered);
  heading_ = heading;
  track_.update(observation.cMo, observation.measured.pose, attempt.tags.front().appearance, frame.utime);
  return {observation, Reason::none, {}};
}

}  // namespace pilotfish::vision
