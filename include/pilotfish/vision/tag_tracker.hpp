#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/vision/stage_stopwatch.hpp"
#include "pilotfish/vision/tag_detector.hpp"
#include "pilotfish/vision/tag_measurement.hpp"
#include "pilotfish/vision/tag_pattern.hpp"
#include "pilotfish/vision/tag_registration.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// The predicted place of a tag in the next picture.
struct TagPrediction {
  std::size_t tag = 0;  ///< which of the body's tags
  /// Tag coordinates (see TagPattern) to the undistorted plane Z = 1, homogeneous.
  Eigen::Matrix3d nHt = Eigen::Matrix3d::Identity();
  double search_px = 0.0;  ///< how far from there it may be; 0: about a third of a cell
};

/// Measures the tags of one body in a picture, each at its prediction, in four stages:
///
///     predict --> search: slide to the best match --> align: fit the template --> read every bit, pass the gates
///
/// track() does the last three in a row; each can also be called by itself. It holds the camera, the templates and the
/// gates, and no state from the pictures: a value. Never throws once it is made, never allocates.
class TagTracker {
 public:
  /// How far from its predicted place a tag is searched for, at most, and at most so many of its cells: beyond, a
  /// detection is cheaper and more reliable.
  static constexpr double kSearch_px = 40.0;
  static constexpr double kSearch_cells = 4.0;  ///< the same in cells of the tag
  /// A tag that is followed may be partly outside the picture, as long as these shares are inside: of its bits, and of
  /// all its cells with those of the frame around them.
  static constexpr double kMinBitsInside = 0.6, kMinCellsInside = 0.5;
  static constexpr double kMinFacing = 0.2;  ///< cosine of the largest viewing angle at which a tag is followed

  /// Of `detector` the gates on bits are used, which are the same for a tag that is detected and one that is tracked.
  /// Throws ConfigError: an invalid camera or body, an unknown family ("leader.family"), an id that the family
  /// does not have ("leader.tags[i].id"), a gate out of its range ("vision. ...").
  TagTracker(const CameraModel& camera, const LeaderBody& body, const TagDetectorConfig& detector = {},
             const TagGates& gates = {});

  /// Where tag `tag` must be if the body is at cMo; nothing if it is behind the camera or not turned towards it.
  std::optional<TagPrediction> predict(std::size_t tag, const Eigen::Isometry3d& cMo) const noexcept;
  /// A tag whose corners [px] are known roughly, bottom left first as a detector gives them.
  TagPrediction predict(std::size_t tag, const std::array<Eigen::Vector2d, 4>& corners_px,
                        double search_px = 0.0) const noexcept;

  /// The prediction's nHt, shifted to where the template matches best within search_px. Refused where nothing
  /// matches, where it is too small to be fitted, and outside the picture.
  TagOutcome<Eigen::Matrix3d> search(const ImageView& image, const TagPrediction& prediction) const noexcept;
  /// The template fitted from there, starting with the gray levels and blur of `expected`. Refused where the fit does
  /// not converge, partly outside the picture, or with cells below min_cell_px.
  TagOutcome<Registration> align(const ImageView& image, std::size_t tag, const Eigen::Matrix3d& nHt,
                                 const Appearance& expected) const noexcept;
  /// The measurement, if the fitted tag is the one that was expected and passes the gates on blur, bits, contrast and
  /// residual.
  TagOutcome<TagMeasurement> read(const ImageView& image, std::size_t tag,
                                  const Registration& registration) const noexcept;

  /// search(), align() and read(). A tag that is followed (search_px > 0) may be partly outside the picture, as long as
  /// kMinBitsInside of its bits are in it; one that was detected may not. `stopwatch`, if there is one, gets a lap
  /// after each.
  TagOutcome<TagMeasurement> track(const ImageView& image, const TagPrediction& prediction, const Appearance& expected,
                                   StageStopwatch* stopwatch = nullptr) const noexcept;

  const CameraModel& camera() const { return camera_; }                        ///< of the pictures
  const LeaderBody& body() const { return body_; }                             ///< whose tags these are
  const TagPattern& pattern(std::size_t tag) const { return patterns_[tag]; }  ///< of tag `tag`
  /// The index of that id among the body's tags; nothing if the body does not have it.
  std::optional<std::size_t> find(int id) const noexcept;
  /// Side of a cell of tag `tag` [px], seen squarely at that depth with that focal length [px].
  double cell_px(std::size_t tag, double focal_px, double depth_m) const noexcept;

 private:
  TagOutcome<Registration> align_anywhere(const ImageView& image, std::size_t tag, const Eigen::Matrix3d& nHt,
                                          const Appearance& expected) const noexcept;
  RefusedValue cell_refused(double cell_px) const noexcept;

  CameraModel camera_;
  LeaderBody body_;
  std::vector<TagPattern> patterns_;  ///< of body_.tags, in their order
  int max_hamming_;
  double min_decision_margin_;
  TagGates gates_;
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
