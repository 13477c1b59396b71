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

  /// Fills all pixels of the camera as seen by a robot with this heading.
  void paint(double robot_heading_rad, Gray16* image) const;

 private:
  struct Place {
    std::int32_t column;     ///< of the panorama for heading zero, in 1/256
    std::int32_t row_start;  ///< index of the first pixel of the panorama's row
    std::uint16_t row_part;  ///< in 1/256, how much of the next row
  };
  std::vector<std::uint8_t> panorama_;
  std::vector<Place> places_;  ///< of every pixel's centre
};

}  // namespace pilotfish::sim
