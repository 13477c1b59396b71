#pragma once

#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/vision/refusals.hpp"
#include "pilotfish/vision/tag_registration.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// Which tags are accepted once they have been found. Defaults: docs/vision.md shows the data they come from.
struct TagGates {
  double min_cell_px = 0.9;               ///< shorter side of a cell
  double max_blur_cells = 0.8;            ///< standard deviation of the blur, in cells
  double max_normalised_residual = 0.12;  ///< RMS of what the template does not explain, as a part of its contrast
  static const std::vector<Parameter<TagGates>>& parameters();
};

/// Which bits are accepted: the same for a detection and for a tag that is followed, see TagDetectorConfig.
struct BitGates {
  int max_hamming = 0;                ///< corrected bits still accepted
  double min_decision_margin = 20.0;  ///< in gray levels
};

/// One tag, verified and measured in this very frame.
struct TagMeasurement {
  TagDetection tag;                            ///< id, bits and the fitted corners [px]
  Matrix8d covariance_px2 = Matrix8d::Zero();  ///< of the corners (u0, v0, u1, v1, ...)
  Appearance appearance;                       ///< Appearance of its template: gray levels and blur
};
using TagMeasurements = BoundedVector<TagMeasurement, kMaxTagsOnBody>;

/// Either the measurement or why there is none.
struct TagResult {
  std::optional<TagMeasurement> measurement;   ///< nothing if it was refused
  TagRefusal refusal = TagRefusal::not_found;  ///< why
};

/// Looks for one known tag near a place and checks what it sees: shift to the best match within `search_px`, fit the
/// template, read every bit, pass the gates. `nHt` is the guess: tag coordinates (see TagPattern) to the undistorted
/// plane Z = 1. Never throws, never allocates.
TagResult track_tag(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                    const Eigen::Matrix3d& nHt, const Appearance& expected, double search_px, const BitGates& bits,
                    const TagGates& gates) noexcept;

/// The homography (tag coordinates to the plane Z = 1) that takes the square's corners to these pixels; not finite if
/// no square can look like that.
Eigen::Matrix3d homography_from_corners(const CameraModel& camera,
                                        const std::array<Eigen::Vector2d, 4>& corners_px) noexcept;
/// The same of a tag at that pose in the camera.
Eigen::Matrix3d homography_from_pose(const Eigen::Isometry3d& cMt, double size_m) noexcept;

}  // namespace pilotfish::vision
PILOTFISH_API_END
