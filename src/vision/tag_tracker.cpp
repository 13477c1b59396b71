#include "pilotfish/vision/tag_tracker.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "is_inside.hpp"
#include "pilotfish/vision/homography.hpp"
#include "tag_reading.hpp"
#include "tag_search.hpp"
#include "tag_warp.hpp"
#include "template_samples.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kMinCorrelation = 0.35;  ///< below, the fit is not attempted
constexpr double kWrongFrameCells = 0.1;  ///< share of the rings that may be dirty
constexpr double kMaxOutliers = 0.25;     ///< share of the pixels that something else may explain
/// The sides that libapriltag finds of a tag with cells below kTiny_px lie 0.15 to 0.45 px too far inside, a third of a
/// cell: from there a fit seldom converges (6 of 21 at 8 m, from 0.2 px farther outside all of them).
constexpr double kTiny_px = 2.0, kOutwards_px = 0.2;
constexpr double kMinMargin_px = 1.0;  ///< of the corners from the picture's edge
constexpr double kMaxUnread = 0.2;     ///< share of the bits that light may hide: 36h11 differs in 11 of 36
constexpr double kMaxOutside = 1.0 - TagTracker::kMinBitsInside;  ///< of a tag that was there just before

bool are_inside(const ImageView& image, const std::array<Eigen::Vector2d, 4>& corners_px) {
  return std::all_of(corners_px.begin(), corners_px.end(), [&](const Eigen::Vector2d& corner) {
    return is_inside(corner, image.width, image.height, kMinMargin_px);
  });
}

double shorter_cell_px(const std::array<Eigen::Vector2d, 4>& c, double cell_side) {
  const double wide = std::min((c[1] - c[0]).norm(), (c[2] - c[3]).norm());
  const double high = std::min((c[0] - c[3]).norm(), (c[1] - c[2]).norm());
  return 0.5 * cell_side * std::min(wide, high);
}

std::vector<TagPattern> patterns_of(const LeaderBody& body) {
  const TagFamily family(body.family);
  std::vector<TagPattern> patterns;
  for (std::size_t i = 0; i < body.tags.size(); ++i) {
    const int id = body.tags[i].id;
    if (id >= family.size())
      throw ConfigError("leader.tags[" + std::to_string(i) + "].id", std::to_string(id) + " is not in " + body.family +
                                                                         ", whose ids are 0 to " +
                                                                         std::to_string(family.size() - 1));
    patterns.push_back(make_pattern(family, id));
  }
  return patterns;
}

}  // namespace

TagTracker::TagTracker(const CameraModel& camera, const LeaderBody& body, const TagDetectorConfig& detector,
                       const TagGates& gates)
    : camera_(camera),
      body_(body),
      max_hamming_(detector.max_hamming),
      min_decision_margin_(detector.min_decision_margin),
      gates_(gates) {
  camera.validate();
  body.validate();
  check_ranges(detector, "vision");
  check_ranges(gates, "vision");
  patterns_ = patterns_of(body);
}

std::optional<std::size_t> TagTracker::find(int id) const noexcept {
  for (std::size_t i = 0; i < patterns_.size(); ++i)
    if (patterns_[i].id == id) return i;
  return std::nullopt;
}

double TagTracker::cell_px(std::size_t tag, double focal_px, double depth_m) const noexcept {
  return 0.5 * patterns_[tag].cell_side * body_.tags[tag].size_m * focal_px / depth_m;
}

std::optional<TagPrediction> TagTracker::predict(std::size_t tag, const Eigen::Isometry3d& cMo) const noexcept {
  const Eigen::Isometry3d cMt = cMo * body_from_tag(body_.tags[tag]);
  const Eigen::Vector3d middle_c = cMt.translation();
  if (!(middle_c.z() > 0.0) || cMt.linear().col(2).dot(middle_c.normalized()) < kMinFacing) return std::nullopt;
  const double search_px = std::min(kSearch_px, kSearch_cells * cell_px(tag, camera_.fx, middle_c.z()));
  return TagPrediction{tag, homography_from_pose(cMt, body_.tags[tag].size_m), search_px};
}

TagPrediction TagTracker::predict(std::size_t tag, const std::array<Eigen::Vector2d, 4>& corners_px,
                                  double search_px) const noexcept {
  if (shorter_cell_px(corners_px, patterns_[tag].cell_side) >= kTiny_px)
    return {tag, homography_from_corners(camera_, corners_px), search_px};
  const Eigen::Vector2d middle = 0.25 * (corners_px[0] + corners_px[1] + corners_px[2] + corners_px[3]);
  std::array<Eigen::Vector2d, 4> outwards_px = corners_px;
  for (Eigen::Vector2d& corner : outwards_px) corner += kOutwards_px * std::sqrt(2.0) * (corner - middle).normalized();
  return {tag, homography_from_corners(camera_, outwards_px), search_px};
}

RefusedValue TagTracker::cell_refused(double cell_px) const noexcept {
  return at_least("side of a cell", cell_px, gates_.min_cell_px, "px");
}

TagOutcome<Eigen::Matrix3d> TagTracker::search(const ImageView& image, const TagPrediction& prediction) const noexcept {
  const TagPattern& pattern = patterns_[prediction.tag];
  const std::array<Eigen::Vector2d, 4> guess_px = tag_corners_px(camera_, TagWarp(camera_, prediction.nHt));
  for (const Eigen::Vector2d& corner : guess_px)
    if (!(corner.cwiseAbs().maxCoeff() < 1e5)) return TagRefusal::not_found;
  const double guess_cell_px = shorter_cell_px(guess_px, pattern.cell_side);
  if (guess_cell_px < 0.5 * gates_.min_cell_px) return {TagRefusal::too_small, cell_refused(guess_cell_px)};
  const std::optional<Shift> shift = find_shift(image, camera_, pattern, prediction.nHt, prediction.search_px);
  if (!shift) return TagRefusal::outside_frame;
  if (shift->correlation < kMinCorrelation)
    return are_inside(image, guess_px) ? TagRefusal::not_found : TagRefusal::outside_frame;

  Eigen::Matrix3d nHt = prediction.nHt;
  if (!shift->px.isZero()) {
    const Eigen::Vector2d middle = nHt.col(2).head<2>() / nHt(2, 2);
    const Eigen::Vector2d move = pixels_from_normalized(camera_, middle).inverse() * shift->px;
    nHt.topRows<2>() += move * nHt.row(2);
  }
  return nHt;
}

TagOutcome<Registration> TagTracker::align(const ImageView& image, std::size_t tag, const Eigen::Matrix3d& nHt,
                                           const Appearance& expected) const noexcept {
  TagOutcome<Registration> fit = align_anywhere(image, tag, nHt, expected);
  if (fit && !are_inside(image, fit->corners_px)) return TagRefusal::outside_frame;
  return fit;
}

TagOutcome<Registration> TagTracker::align_anywhere(const ImageView& image, std::size_t tag, const Eigen::Matrix3d& nHt,
                                                    const Appearance& expected) const noexcept {
  const std::optional<Registration> fit = register_tag(image, camera_, patterns_[tag], nHt, expected);
  if (!fit) return TagRefusal::not_found;
  if (fit->cell_px < gates_.min_cell_px) return {TagRefusal::too_small, cell_refused(fit->cell_px)};
  return *fit;
}

TagOutcome<TagMeasurement> TagTracker::read(const ImageView& image, std::size_t tag,
                                            const Registration& fit) const noexcept {
  const double blur_px = std::sqrt(std::max(fit.appearance.blur_u_px2, fit.appearance.blur_v_px2));
  const double most_blur_px = gates_.max_blur_cells * fit.cell_px;
  if (blur_px > most_blur_px) return {TagRefusal::too_blurred, at_most("blur", blur_px, most_blur_px, "px")};
  const TagReading reading = read_tag(image, camera_, patterns_[tag], fit);
  const bool inside = are_inside(image, fit.corners_px);
  // Of two tags of 36h11 at least 11 bits differ: a fifth may be hidden, or two fifths be outside of a tag that was
  // whole just before, but not both, or too few are left that tell them apart.
  if (reading.outside_bits > kMaxOutside * reading.bits) return TagRefusal::outside_frame;
  if (reading.unread_bits > (reading.outside_bits == 0 ? kMaxUnread * reading.bits : 0.0))
    return inside ? TagRefusal::hamming : TagRefusal::outside_frame;
  if (reading.wrong_bits > max_hamming_)
    return {TagRefusal::hamming, at_most("wrong bits", reading.wrong_bits, max_hamming_)};
  if (reading.wrong_frame_cells > kWrongFrameCells * reading.frame_cells) return TagRefusal::hamming;
  if (reading.decision_margin < min_decision_margin_)
    return {TagRefusal::margin, at_least("contrast", reading.decision_margin, min_decision_margin_, "gray levels")};
  const double residual = fit.residual_rms / fit.appearance.contrast();
  const double most = (fit.cell_px < kDenseBelow_px ? kPixelResidual : 1.0) * gates_.max_normalised_residual;
  if (!(residual <= most)) return {TagRefusal::residual, at_most("normalised residual", residual, most)};
  if (fit.outlier_share > kMaxOutliers)
    return {TagRefusal::residual, at_most("outlier share", fit.outlier_share, kMaxOutliers)};

  TagMeasurement measurement;
  measurement.tag = {patterns_[tag].id, reading.wrong_bits, reading.decision_margin, fit.corners_px};
  measurement.covariance_px2 = fit.covariance_px2;
  measurement.appearance = fit.appearance;
  return measurement;
}

TagOutcome<TagMeasurement> TagTracker::track(const ImageView& image, const TagPrediction& prediction,
                                             const Appearance& expected, StageStopwatch* stopwatch) const noexcept {
  const auto lap = [stopwatch](Stage stage) {
    if (stopwatch != nullptr) stopwatch->lap(stage);
  };
  const TagOutcome<Eigen::Matrix3d> start = search(image, prediction);
  lap(Stage::search);
  if (!start) return {start.refusal, start.refused};
  const TagOutcome<Registration> fit = align_anywhere(image, prediction.tag, *start, expected);
  lap(Stage::align);
  if (!fit) return {fit.refusal, fit.refused};
  // What a search found, it has not seen before; what is followed may be partly outside.
  if (!(prediction.search_px > 0.0) && !are_inside(image, fit->corners_px)) return TagRefusal::outside_frame;
  TagOutcome<TagMeasurement> measured = read(image, prediction.tag, *fit);
  lap(Stage::read);
  return measured;
}

}  // namespace pilotfish::vision
