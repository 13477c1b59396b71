#include "textured_regions.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "gray_tiles.hpp"

namespace pilotfish::vision {
namespace {

constexpr int kTile_px = 4;
constexpr int kMaxTiles = 480 * 270;    ///< of 1920 x 1080; a larger picture is looked at with larger tiles
constexpr int kActiveOfNine = 8;        ///< so many tiles of 3 x 3 have the contrast
constexpr double kNoise = 2.0;          ///< times the median contrast of tiles, which is that of noise
constexpr int kRoomTiles = 5;           ///< around them: half of a tag with cells of 5 px
constexpr double kLargestShare = 0.25;  ///< of the picture
constexpr int kBlockTiles = 8;          ///< regions are made of blocks of so many tiles squared
constexpr int kMaxBlocks = 64 * 64;

using Tiles = std::array<std::uint8_t, kMaxTiles>;

struct Grid {
  int tile_px = kTile_px, columns = 0, rows = 0;
};

/// Largest less smallest gray of every tile.
void measure_contrast(const ImageView& image, const Grid& grid, Tiles& contrast) {
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      contrast[static_cast<std::size_t>(row) * grid.columns + column] =
          gray_range(image, column * grid.tile_px, row * grid.tile_px, grid.tile_px);
    }
}

int median_of(const Tiles& contrast, int count) {
  std::array<int, 256> histogram{};
  for (int i = 0; i < count; ++i) ++histogram[contrast[i]];
  return quantile_of(histogram, count, 2);
}

/// How many middles of 3 x 3 tiles with contrast lie in each block.
struct Blocks {
  int columns = 0, rows = 0;
  std::array<int, kMaxBlocks> hits{};
};

}  // namespace

TexturedRegions textured_regions(const ImageView& image, int min_contrast) noexcept {
  TexturedRegions regions;
  Grid grid;
  while ((image.width / grid.tile_px) * (image.height / grid.tile_px) > kMaxTiles) grid.tile_px *= 2;
  grid.columns = image.width / grid.tile_px;
  grid.rows = image.height / grid.tile_px;
  if (grid.columns < 3 || grid.rows < 3) return regions;
  Tiles contrast;
  measure_contrast(image, grid, contrast);
  const double noise = kNoise * median_of(contrast, grid.columns * grid.rows);
  const int threshold = std::min(static_cast<int>(std::max<double>(min_contrast, noise)), 120);

  Blocks blocks;
  int block_tiles = kBlockTiles;
  const auto blocks_along = [&](int tiles) { return (tiles + block_tiles - 1) / block_tiles; };
  while (blocks_along(grid.columns) * blocks_along(grid.rows) > kMaxBlocks) block_tiles *= 2;
  blocks.columns = blocks_along(grid.columns);
  blocks.rows = blocks_along(grid.rows);
  for (int row = 1; row + 1 < grid.rows; ++row) {
    const std::uint8_t* middle = contrast.data() + static_cast<std::ptrdiff_t>(row) * grid.columns;
    const auto active = [&](int column) {
      return (middle[column - grid.columns] >= threshold) + (middle[column] >= threshold) +
             (middle[column + grid.columns] >= threshold);
    };
    int a = active(0), b = active(1);
    for (int column = 1; column + 1 < grid.columns; ++column) {
      const int c = active(column + 1);
      if (a + b + c >= kActiveOfNine) ++blocks.hits[row / block_tiles * blocks.columns + column / block_tiles];
      a = b;
      b = c;
    }
  }

  double left_px = kLargestShare * image.width * image.height;
  while (!regions.full()) {
    const auto best = std::max_element(blocks.hits.begin(),
                                       blocks.hits.begin() + static_cast<std::ptrdiff_t>(blocks.columns) * blocks.rows);
    if (*best == 0) break;
    const int index = static_cast<int>(best - blocks.hits.begin());
    int first_column = index % blocks.columns, last_column = first_column;
    int first_row = index / blocks.columns, last_row = first_row;
    // Grown by blocks that have hits, as far as one tag may reach.
    const auto hits_in = [&](int c0, int c1, int r0, int r1) {
      int sum = 0;
      for (int r = std::max(r0, 0); r <= std::min(r1, blocks.rows - 1); ++r)
        for (int c = std::max(c0, 0); c <= std::min(c1, blocks.columns - 1); ++c)
          sum += blocks.hits[r * blocks.columns + c];
      return sum;
    };
    if (hits_in(first_column - 1, first_column - 1, first_row - 1, last_row + 1) > 0) --first_column;
    if (hits_in(last_column + 1, last_column + 1, first_row - 1, last_row + 1) > 0) ++last_column;
    if (hits_in(first_column, last_column, first_row - 1, first_row - 1) > 0) --first_row;
    if (hits_in(first_column, last_column, last_row + 1, last_row + 1) > 0) ++last_row;
    for (int r = std::max(first_row, 0); r <= std::min(last_row, blocks.rows - 1); ++r)
      for (int c = std::max(first_column, 0); c <= std::min(last_column, blocks.columns - 1); ++c)
        blocks.hits[r * blocks.columns + c] = 0;
    const int side_px = block_tiles * grid.tile_px, room_px = kRoomTiles * grid.tile_px;
    SearchRegion region;
    region.left = std::max(0, first_column * side_px - room_px);
    region.top = std::max(0, first_row * side_px - room_px);
    region.width = std::min(image.width, (last_column + 1) * side_px + room_px) - region.left;
    region.height = std::min(image.height, (last_row + 1) * side_px + room_px) - region.top;
    left_px -= static_cast<double>(region.width) * region.height;
    if (left_px < 0.0) break;
    if (region.width >= kMinFrameSide && region.height >= kMinFrameSide) regions.push_back(region);
  }
  return regions;
}

}  // namespace pilotfish::vision
