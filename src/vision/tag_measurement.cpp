#include "pilotfish/vision/tag_measurement.hpp"

namespace pilotfish::vision {

const std::vector<Parameter<TagGates>>& TagGates::parameters() {
  static const std::vector<Parameter<TagGates>> table = {
      {"min_cell_px", &TagGates::min_cell_px, 0.5, 50.0, "shorter side of a tag's cell below which it is refused"},
      {"max_blur_cells", &TagGates::max_blur_cells, 0.1, 2.0,
       "standard deviation of the blur, in cells of the tag, above which it is refused"},
      {"max_normalised_residual", &TagGates::max_normalised_residual, 0.01, 1.0,
       "RMS difference of picture and template, as a part of the contrast, above which a tag is refused"},
  };
  return table;
}

}  // namespace pilotfish::vision
