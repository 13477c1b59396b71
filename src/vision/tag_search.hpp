#pragma once

#include <optional>

#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/vision/tag_pattern.hpp"

namespace pilotfish::vision {

/// Where in the picture the template matches best.
struct Shift {
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
  double correlation = 0.0;  ///< of the cells' colours with the grays in their middles, -1 to 1
};

/// Slides the template over the picture by up to `search_px` in both directions, in steps of half a cell; where it
/// already lies well it is not slid at all. Nothing if it lies outside the picture.
std::optional<Shift> find_shift(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                                const Eigen::Matrix3d& nHt, double search_px) noexcept;

}  // namespace pilotfish::vision
