#include "pilotfish/vision/tag_pattern.hpp"

#include <apriltag/apriltag.h>

#include <algorithm>
#include <limits>

namespace pilotfish::vision {
namespace {

enum Colour : std::uint8_t { kBlack = 0, kWhite = 1, kFree = 2 };

/// The template of one tag: total_width cells a side, and which of them are bits of the code.
struct TagTemplate {
  int side = 0;
  std::vector<std::uint8_t> colour;
  std::vector<bool> is_bit;
  std::uint8_t& at(int column, int row) { return colour[static_cast<std::size_t>(row) * side + column]; }
};

void draw_ring(TagTemplate& printed, int width, Colour colour) {
  const int first = (printed.side - width) / 2, last = first + width - 1;
  for (int i = first; i <= last; ++i)
    for (auto [column, row] : {std::pair{i, first}, {i, last}, {first, i}, {last, i}}) printed.at(column, row) = colour;
}

/// As apriltag_to_image() draws it; but that leaves black what a family leaves free (the corners of a circle, the hole
/// of a Custom48h12), and those cells may have any colour.
TagTemplate template_of(const apriltag_family_t& family, int id) {
  TagTemplate printed;
  printed.side = family.total_width;
  printed.colour.assign(static_cast<std::size_t>(printed.side) * printed.side, kFree);
  printed.is_bit.assign(printed.colour.size(), false);
  // The detected square is where the two rings meet: black inside white, or with a reversed border white inside black.
  draw_ring(printed, family.width_at_border, family.reversed_border ? kWhite : kBlack);
  draw_ring(printed, family.width_at_border + 2, family.reversed_border ? kBlack : kWhite);
  const int origin = (printed.side - family.width_at_border) / 2;
  for (std::uint32_t i = 0; i < family.nbits; ++i) {
    const int column = static_cast<int>(family.bit_x[i]) + origin, row = static_cast<int>(family.bit_y[i]) + origin;
    const bool white = (family.codes[id] >> (family.nbits - 1 - i)) & 1U;
    printed.at(column, row) = white ? kWhite : kBlack;
    printed.is_bit[static_cast<std::size_t>(row) * printed.side + column] = true;
  }
  return printed;
}

std::uint8_t nearest_known(TagTemplate& printed, int column, int row) {
  std::uint8_t colour = kWhite;
  int nearest = std::numeric_limits<int>::max();
  for (int j = 0; j < printed.side; ++j)
    for (int i = 0; i < printed.side; ++i) {
      const int distance = (i - column) * (i - column) + (j - row) * (j - row);
      if (printed.at(i, j) == kFree || distance >= nearest) continue;
      nearest = distance;
      colour = printed.at(i, j);
    }
  return colour;
}

}  // namespace

TagPattern make_pattern(const TagFamily& family, int id) {
  family.bitmap(id);  // throws on an id that does not exist
  TagTemplate printed = template_of(*family.get(), id);
  TagPattern pattern;
  pattern.id = id;
  pattern.cell_side = 2.0 / family.cells_at_border();
  pattern.cells = printed.side + 2 * TagPattern::kMargin;
  for (int row = -TagPattern::kMargin; row < printed.side + TagPattern::kMargin; ++row)
    for (int column = -TagPattern::kMargin; column < printed.side + TagPattern::kMargin; ++column)
      pattern.colour.push_back(nearest_known(printed, column, row));

  const double first = -0.5 * printed.side * pattern.cell_side;  // left and upper rim of the template
  const auto line = [&](double cells) { return first + cells * pattern.cell_side; };
  const auto differ = [](std::uint8_t a, std::uint8_t b) { return a != b && a != kFree && b != kFree; };
  for (int row = 0; row < printed.side; ++row)
    for (int column = 0; column < printed.side; ++column) {
      const std::uint8_t colour = printed.at(column, row);
      if (colour == kFree) continue;
      pattern.known.push_back({{line(column + 0.5), line(row + 0.5)},
                               colour == kWhite,
                               printed.is_bit[static_cast<std::size_t>(row) * printed.side + column]});
      if (column + 1 < printed.side && differ(colour, printed.at(column + 1, row)))
        pattern.edges.push_back({{line(column + 1), line(row + 0.5)}, true});
      if (row + 1 < printed.side && differ(colour, printed.at(column, row + 1)))
        pattern.edges.push_back({{line(column + 0.5), line(row + 1)}, false});
    }
  return pattern;
}

}  // namespace pilotfish::vision
