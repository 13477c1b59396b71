#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/vision/tag_family.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// A tag as template, in its own plane. Tag coordinates (x, y): the corners of the black square (AprilTag's "border")
/// are at
/// (+-1, +-1), x right and y down as one reads it. The cells around a code are part of the template: the white ring of
/// a 36h11, the outer bits of a Standard41h12.
struct TagPattern {
  /// Where black meets white: one side of a cell, both sides known.
  struct Edge {
    Eigen::Vector2d middle;  ///< of the side
    bool vertical = false;   ///< it runs along y, so that crossing it is a step in x
  };
  /// A cell of known colour.
  struct Cell {
    Eigen::Vector2d centre;  ///< of the cell
    bool white = false;      ///< else black
    bool data = false;       ///< one bit of the code; otherwise part of the frame that all tags of the family share
  };

  int id = 0;               ///< in its family
  double cell_side = 0.25;  ///< in tag coordinates
  int cells = 0;            ///< per side of `colour`, with a margin of kMargin cells all around
  /// Row by row, 0 black and 1 white. Cells that the family leaves free, and the margin, repeat their nearest known
  /// neighbour.
  std::vector<std::uint8_t> colour;
  std::vector<Edge> edges;  ///< all of them
  std::vector<Cell> known;  ///< cells with a colour

  static constexpr int kMargin = 3;  ///< cells around the tag
};

/// Throws std::out_of_range on an id that the family does not have.
TagPattern make_pattern(const TagFamily& family, int id);

}  // namespace pilotfish::vision
PILOTFISH_API_END
