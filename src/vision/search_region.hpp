#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "pilotfish/vision/tag_tracker.hpp"

namespace pilotfish::vision {

/// A part of the picture in which the leader is searched for.
struct SearchRegion {
  int left = 0, top = 0, width = 0, height = 0;
  double cell_px = 0.0;  ///< of its nearest tag's cells, about
};

/// The body's tags at that pose, with half as much again on every side and at least `margin_px`; nothing if they are
/// behind the camera or outside the picture.
inline std::optional<SearchRegion> region_around(const TagTracker& tracker, const Eigen::Isometry3d& cMo,
                                                 double margin_px) {
  const CameraModel& camera = tracker.camera();
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9, cell_px = 0.0;
  for (std::size_t i = 0; i < tracker.body().tags.size(); ++i) {
    const BodyTag& tag = tracker.body().tags[i];
    for (const Eigen::Vector3d& corner_o : corners_on_body(tag)) {
      const std::optional<Eigen::Vector2d> pixel = project(camera, cMo * corner_o);
      if (!pixel || !pixel->allFinite()) return std::nullopt;
      left = std::min(left, pixel->x());
      right = std::max(right, pixel->x());
      top = std::min(top, pixel->y());
      bottom = std::max(bottom, pixel->y());
    }
    const double depth_m = (cMo * body_from_tag(tag)).translation().z();
    cell_px = std::max(cell_px, tracker.cell_px(i, camera.fx, depth_m));
  }
  const double margin = std::max(margin_px, 0.5 * std::max(right - left, bottom - top));
  const auto clamped = [](double value, int size) { return static_cast<int>(std::clamp(value, 0.0, size - 1.0)); };
  SearchRegion region;
  region.left = clamped(left - margin, camera.width);
  region.top = clamped(top - margin, camera.height);
  region.width = clamped(right + margin, camera.width) - region.left + 1;
  region.height = clamped(bottom + margin, camera.height) - region.top + 1;
  region.cell_px = cell_px;
  if (region.width < kMinFrameSide || region.height < kMinFrameSide) return std::nullopt;
  return region;
}

/// The whole picture.
inline SearchRegion whole(const ImageView& image) { return {0, 0, image.width, image.height, 0.0}; }

/// That part of the picture: the same memory, nothing is copied.
inline ImageView part_of(const ImageView& image, const SearchRegion& region) {
  const std::size_t offset =
      static_cast<std::size_t>(region.top) * image.stride_bytes + static_cast<std::size_t>(region.left);
  return {image.data + offset, image.size_bytes - offset, region.width, region.height, image.stride_bytes};
}

}  // namespace pilotfish::vision
