#pragma once

#include <cstdint>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/vision/tag_registration.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// Which tags are accepted once they have been found. Defaults: docs/vision.md shows the data they come from.
struct TagGates {
  PILOTFISH_PARAMETERS(TagGates);
  PILOTFISH_PARAMETER(double, min_cell_px, 0.9, 0.5, 50.0, "shorter side of a tag's cell below which it is refused");
  PILOTFISH_PARAMETER(double, max_blur_cells, 0.8, 0.1, 2.0,
                      "standard deviation of the blur, in cells of the tag, above which it is refused");
  PILOTFISH_PARAMETER(
      double, max_normalised_residual, 0.12, 0.01, 1.0,
      "RMS difference of picture and template, as a part of the contrast, above which a tag is refused");
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

/// Why a tag that was looked at is no measurement.
enum class TagRefusal : std::uint8_t {
  not_found,      ///< nothing like it at that place
  outside_frame,  ///< partly outside the picture
  too_small,      ///< cells below min_cell_px
  too_blurred,    ///< blur above max_blur_cells
  hamming,        ///< it reads as something else
  margin,         ///< too little contrast
  residual,       ///< it reads well, but something else explains too much of it
};

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
