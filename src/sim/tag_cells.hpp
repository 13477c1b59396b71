#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pilotfish::sim {

/// A tag as it is printed: cells x cells fields, row by row from the top left, 0 black, 255 white.
struct TagCells {
  int cells = 0;         ///< per side, with the quiet zone where the family has one
  int black_square = 0;  ///< cells per side of the square that a tag's size_m means
  std::vector<std::uint8_t> grays;
};

/// From libapriltag. Throws ConfigError ("leader.family", "leader.tags") if there is no such family or id.
std::vector<TagCells> tag_cells(const std::string& family, const std::vector<int>& ids);

}  // namespace pilotfish::sim
