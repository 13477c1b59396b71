#pragma once

#include <array>

#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/vision/tag_pattern.hpp"
#include "tag_warp.hpp"

namespace pilotfish::vision {

/// The gray levels of black and of white in every cell of a template, from the grays in the middles of the cells around
/// it: what light a shadow's edge or a reflection leaves where. Between middles they are interpolated.
class LevelField {
 public:
  /// Gray levels at a place.
  struct Levels {
    double black = 0.0, white = 0.0;
  };
  /// How light changes from cell to cell.
  enum class Light {
    smooth,   ///< a reflection, a wide penumbra: levels lie on curved surfaces
    stepped,  ///< the edge of a shadow: they are means of what is near
  };
  /// With `without_own`, a cell's own gray does not count for its own levels: its colour can be judged by them.
  /// `reach_cells` is the standard deviation of the weights. False if too few cells are in the picture.
  bool measure(const ImageView& image, const CameraModel& camera, const TagWarp& warp, const TagPattern& pattern,
               Light light, double reach_cells, bool without_own);
  Levels at(const Eigen::Vector2d& tag) const;  ///< in tag coordinates

 private:
  static constexpr int kSide = 14;  ///< cells of the largest family's print, with its rings
  const Levels& cell(int column, int row) const { return levels_[static_cast<std::size_t>(row) * kSide + column]; }

  int side_ = 0;
  double cell_side_ = 1.0;
  std::array<Levels, static_cast<std::size_t>(kSide) * kSide> levels_{};
};

}  // namespace pilotfish::vision
