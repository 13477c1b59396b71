#pragma once

#include <cstdint>
#include <vector>

#include "pilotfish/core/camera_model.hpp"
#include "ray_grid.hpp"

namespace pilotfish::sim {

/// Gray levels in 1/256, so that blur and noise see no steps.
using Gray16 = std::uint16_t;

/// What is behind everything: a wall with posters, crates and cables above a tiled floor, painted from a seed
/// on a cylinder infinitely far away. It turns with the camera, but does not come nearer.
class Background {
 public:
  Background(const RayGrid& grid, const CameraMounting& mounting, double contrast, std::uint64_t seed);

  /// Fills the pixels from `first` to before `end` (row by row) as seen by a robot with this heading.
  void paint(double robot_heading_rad, std::size_t first, std::size_t end, Gray16* image) const;

 private:
  /// The rows that the camera sees. Every word holds the four pixels between which a point lies: itself, the one to its
  /// right, the one below, the one to the right of that, from the lowest byte up.
  std::vector<std::uint32_t> panorama_;
  /// Of every pixel's centre: the column for heading zero in 1/256, and the index of the row's first word in 1/256.
  std::vector<std::uint32_t> columns_, rows_;
  bool plain_ = false;  ///< without contrast everything is one gray
};

}  // namespace pilotfish::sim
