#pragma once

#include <vector>

#include "background.hpp"
#include "pilotfish/sim/renderer.hpp"
#include "ray_grid.hpp"

namespace pilotfish::sim {

/// Draws all surfaces of all bodies over what is in these rows of the image, each pixel with the exact mean of what it
/// covers.
void draw(const CameraModel& camera, const RayGrid& grid, const std::vector<VisibleBody>& bodies, int first_row,
          int end_row, Gray16* image);

}  // namespace pilotfish::sim
