#include "rasterizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "convex_polygon.hpp"
#include "facets.hpp"
#include "wider_registers.hpp"

namespace pilotfish::sim {
namespace {

struct Box {
  int left, right, top, bottom;
};

/// Which facet and cell the ray through each corner of the pixels in `box` meets first.
struct Hits {
  static constexpr std::int16_t kNothing = -1;
  Box box;
  int stride;
  std::vector<float> nearness;
  std::vector<std::int16_t> facet;
  std::vector<std::int16_t> cell;

  explicit Hits(const Box& b) : box(b), stride(b.right - b.left + 1) {
    const auto count = static_cast<std::size_t>(stride) * (b.bottom - b.top + 1);
    nearness.assign(count, 0.0F);
    facet.assign(count, kNothing);
    cell.assign(count, 0);
  }
  std::size_t at(int u, int v) const { return static_cast<std::size_t>(v - box.top) * stride + (u - box.left); }
};

PILOTFISH_FOR_WIDER_REGISTERS
void hit(const Facet& facet, std::int16_t index, const RayGrid& grid, Hits& hits) {
  const Eigen::Matrix3f m = facet.from_ray.cast<float>();
  const auto priority = static_cast<float>(facet.priority);
  for (int v = facet.top; v <= facet.bottom; ++v) {
    const std::size_t ray = static_cast<std::size_t>(v) * grid.columns;
    const std::size_t row = hits.at(facet.left, v);
    for (int u = facet.left; u <= facet.right; ++u) {
      const std::size_t here = row + static_cast<std::size_t>(u - facet.left);
      const float x = grid.x[ray + u], y = grid.y[ray + u];
      const float w = m(2, 0) * x + m(2, 1) * y + m(2, 2);
      const float a = m(0, 0) * x + m(0, 1) * y + m(0, 2);
      const float b = m(1, 0) * x + m(1, 1) * y + m(1, 2);
      const bool nearest =
          (int(std::abs(a) <= w) & int(std::abs(b) <= w) & int(w * priority > hits.nearness[here])) != 0;
      hits.nearness[here] = nearest ? w * priority : hits.nearness[here];
      hits.facet[here] = nearest ? index : hits.facet[here];
    }
  }
}

int cell_along(double coordinate, int cells) {
  return std::clamp(static_cast<int>((coordinate + 1.0) * 0.5 * cells), 0, cells - 1);
}

/// The same for a row of rays, as row * cells + column. `m`: Facet::from_ray, row by row. No operation is fused here
/// either (see wider_registers.hpp: AVX2 has none), so that all processors find the same.
PILOTFISH_FOR_WIDER_REGISTERS
void cells_of_rays(const float* x, const float* y, std::size_t count, const std::array<float, 9>& m, int cells,
                   std::int32_t* found) {
  for (std::size_t i = 0; i < count; ++i) {
    const float inverse = 1.0F / (m[6] * x[i] + m[7] * y[i] + m[8]);
    const float a = (m[0] * x[i] + m[1] * y[i] + m[2]) * inverse, b = (m[3] * x[i] + m[4] * y[i] + m[5]) * inverse;
    const auto column = static_cast<std::int32_t>((static_cast<double>(a) + 1.0) * 0.5 * cells);
    const auto row = static_cast<std::int32_t>((static_cast<double>(b) + 1.0) * 0.5 * cells);
    found[i] = std::min(std::max(row, 0), cells - 1) * cells + std::min(std::max(column, 0), cells - 1);
  }
}

/// Row * cells + column of the cell, for the corners that meet this facet.
void find_cells(const Facet& facet, std::int16_t index, const RayGrid& grid, Hits& hits) {
  std::array<float, 9> m;
  for (int i = 0; i < 9; ++i) m[static_cast<std::size_t>(i)] = static_cast<float>(facet.from_ray(i / 3, i % 3));
  std::vector<std::int32_t> found(static_cast<std::size_t>(facet.right - facet.left + 1));
  for (int v = facet.top; v <= facet.bottom; ++v) {
    // From the first to the last ray of the row that meets this facet; in between few meet another.
    std::size_t first = hits.at(facet.left, v), last = hits.at(facet.right, v) + 1;
    while (first < last && hits.facet[first] != index) ++first;
    while (first < last && hits.facet[last - 1] != index) --last;
    const std::size_t ray =
        static_cast<std::size_t>(v) * grid.columns + hits.box.left + (first - hits.at(hits.box.left, v));
    cells_of_rays(grid.x.data() + ray, grid.y.data() + ray, last - first, m, facet.cells, found.data());
    for (std::size_t here = first; here < last; ++here)
      if (hits.facet[here] == index) hits.cell[here] = static_cast<std::int16_t>(found[here - first]);
  }
}

/// Integral of the facet's gray over a polygon inside it: the polygon, cut into columns and these into rows of cells.
double integral(const Facet& facet, const ConvexPolygon& polygon) {
  if (facet.cells == 1) return polygon.area() * facet.grays[0];
  const auto range = [&](const ConvexPolygon& of, int axis) {
    const Line2 s = facet.row(axis), w = facet.row(2);
    std::pair<int, int> first_last{facet.cells, -1};
    for (std::size_t i = 0; i < static_cast<std::size_t>(of.size); ++i) {
      const double x = of.x[i], y = of.y[i];
      const int cell = cell_along(s.at(x, y) / w.at(x, y), facet.cells);
      first_last = {std::min(first_last.first, cell), std::max(first_last.second, cell)};
    }
    return first_last;
  };
  // What lies before a line of the grid is taken, what lies beyond stays as the rest for the next line.
  const auto for_each_strip = [&](const ConvexPolygon& of, int axis, const auto& take) {
    const auto [first, last] = range(of, axis);
    std::array<ConvexPolygon, 2> beyond;
    ConvexPolygon before;
    const ConvexPolygon* rest = &of;
    for (int i = first; i < last; ++i) {
      ConvexPolygon& next = beyond[static_cast<std::size_t>(i - first) % 2];
      switch (cut(*rest, facet.line(axis, 2.0 * (i + 1) / facet.cells - 1.0), next, before)) {
        case Side::positive: break;
        case Side::negative: take(*rest, i); return;
        case Side::both:
          take(before, i);
          rest = &next;
          break;
      }
    }
    take(*rest, last);
  };
  double sum = 0.0;
  for_each_strip(polygon, 0, [&](const ConvexPolygon& column, int i) {
    for_each_strip(column, 1,
                   [&](const ConvexPolygon& cell, int j) { sum += cell.area() * facet.grays[j * facet.cells + i]; });
  });
  return sum;
}

ConvexPolygon pixel_at(const RayGrid& grid, int u, int v) {
  ConvexPolygon pixel;
  for (const auto& [du, dv] : {std::pair{0, 0}, std::pair{1, 0}, std::pair{1, 1}, std::pair{0, 1}}) {
    const std::size_t corner = static_cast<std::size_t>(v + dv) * grid.columns + (u + du);
    pixel.add(grid.x[corner], grid.y[corner]);
  }
  return pixel;
}

/// False if all of the pixel is beyond one of the facet's sides.
bool touches(const Facet& facet, const ConvexPolygon& pixel) {
  return std::all_of(facet.sides.begin(), facet.sides.end(), [&](const Line2& side) {
    for (std::size_t i = 0; i < 4; ++i)
      if (side.at(pixel.x[i], pixel.y[i]) > 0.0) return true;
    return false;
  });
}

/// Memory for mean_gray(), made once for all pixels.
struct Scratch {
  static constexpr std::size_t kMaxPieces = 32;
  std::vector<std::pair<double, const Facet*>> near_first;
  std::array<ConvexPolygon, kMaxPieces> uncovered, remaining;
};

/// The exact mean over one pixel: the nearest facet takes its part of what is still uncovered, and so on to
/// the background. `facets`: those that the pixel's row may touch.
double mean_gray(const std::vector<const Facet*>& facets, const ConvexPolygon& pixel, int u, double background,
                 Scratch& scratch) {
  const double middle_x = (pixel.x[0] + pixel.x[2]) / 2.0, middle_y = (pixel.y[0] + pixel.y[2]) / 2.0;
  auto& [near_first, uncovered, remaining] = scratch;
  near_first.clear();
  for (const Facet* facet : facets)
    if (u >= facet->left && u < facet->right && touches(*facet, pixel))
      near_first.emplace_back(-facet->row(2).at(middle_x, middle_y) * facet->priority, facet);
  std::sort(near_first.begin(), near_first.end(),
            [](const auto& one, const auto& other) { return one.first < other.first; });

  std::size_t uncovered_count = 1;
  uncovered[0] = pixel;
  double sum = 0.0;
  ConvexPolygon inside, part, outside;
  for (std::size_t k = 0; k < near_first.size() && uncovered_count > 0; ++k) {
    const Facet& facet = *near_first[k].second;
    std::size_t remaining_count = 0;
    for (std::size_t i = 0; i < uncovered_count; ++i) {
      const std::size_t before = remaining_count;
      inside = uncovered[i];
      bool touched = true;
      for (const Line2& side : facet.sides) {
        const Side lies = cut(inside, side, part, outside);
        touched = lies != Side::negative;
        if (!touched) break;
        if (lies == Side::positive) continue;
        inside = part;
        if (outside.size > 2 && remaining_count < Scratch::kMaxPieces) remaining[remaining_count++] = outside;
        touched = inside.size > 2;
        if (!touched) break;
      }
      if (touched) {
        sum += integral(facet, inside);
      } else {  // leave it in one piece
        remaining_count = before;
        if (remaining_count < Scratch::kMaxPieces) remaining[remaining_count++] = uncovered[i];
      }
    }
    std::copy_n(remaining.begin(), remaining_count, uncovered.begin());
    uncovered_count = remaining_count;
  }
  for (std::size_t i = 0; i < uncovered_count; ++i) sum += uncovered[i].area() * background;
  return sum / pixel.area();
}

/// Whether a pixel whose corners meet these four cells of one facet has one gray: its image lies in their bounding box.
bool same_gray(const Facet& facet, const std::array<std::int16_t, 4>& corners) {
  if (corners[0] == corners[1] && corners[0] == corners[2] && corners[0] == corners[3]) return true;
  const float at_first = facet.grays[corners[0]];
  for (std::int16_t cell : corners)
    if (facet.grays[cell] != at_first) return false;
  int left = facet.cells, right = 0, top = facet.cells, bottom = 0;
  for (std::int16_t cell : corners) {
    left = std::min(left, cell % facet.cells);
    right = std::max(right, cell % facet.cells);
    top = std::min(top, cell / facet.cells);
    bottom = std::max(bottom, cell / facet.cells);
  }
  const float first = facet.grays[top * facet.cells + left];
  for (int row = top; row <= bottom; ++row)
    for (int column = left; column <= right; ++column)
      if (facet.grays[row * facet.cells + column] != first) return false;
  return true;
}

std::vector<Facet> within(std::vector<Facet> facets, int first_row, int end_row) {
  for (Facet& facet : facets) {
    facet.top = std::max(facet.top, first_row);
    facet.bottom = std::min(facet.bottom, end_row);
  }
  facets.erase(
      std::remove_if(facets.begin(), facets.end(), [](const Facet& facet) { return facet.top >= facet.bottom; }),
      facets.end());
  return facets;
}

}  // namespace

void draw(const CameraModel& camera, const RayGrid& grid, const std::vector<VisibleBody>& bodies, int first_row,
          int end_row, Gray16* image) {
  std::vector<std::uint8_t> crossed(static_cast<std::size_t>(camera.width) * camera.height, 0);
  const std::vector<Facet> facets = within(facets_of(camera, grid, bodies, crossed), first_row, end_row);
  if (facets.empty()) return;
  Box box{camera.width, 0, camera.height, 0};
  for (const Facet& facet : facets)
    box = {std::min(box.left, facet.left), std::max(box.right, facet.right), std::min(box.top, facet.top),
           std::max(box.bottom, facet.bottom)};
  Hits hits(box);
  for (std::size_t i = 0; i < facets.size(); ++i) hit(facets[i], static_cast<std::int16_t>(i), grid, hits);
  for (std::size_t i = 0; i < facets.size(); ++i)
    if (facets[i].cells > 1) find_cells(facets[i], static_cast<std::int16_t>(i), grid, hits);

  Scratch scratch;
  std::vector<const Facet*> in_row;
  for (int v = box.top; v < box.bottom; ++v) {
    in_row.clear();
    for (const Facet& facet : facets)
      if (v >= facet.top && v < facet.bottom) in_row.push_back(&facet);
    for (int u = box.left; u < box.right; ++u) {
      const std::size_t upper = hits.at(u, v), lower = hits.at(u, v + 1);
      const std::size_t pixel = static_cast<std::size_t>(v) * camera.width + u;
      const std::int16_t index = hits.facet[upper];
      const bool one_facet = crossed[pixel] == 0 && index == hits.facet[upper + 1] && index == hits.facet[lower] &&
                             index == hits.facet[lower + 1];
      if (one_facet && index == Hits::kNothing) continue;
      const Facet& facet = facets[static_cast<std::size_t>(std::max<std::int16_t>(index, 0))];
      double gray = 0.0;
      if (!one_facet) {
        gray = mean_gray(in_row, pixel_at(grid, u, v), u, image[pixel] / 256.0, scratch);
      } else if (same_gray(facet, {hits.cell[upper], hits.cell[upper + 1], hits.cell[lower], hits.cell[lower + 1]})) {
        gray = facet.grays[hits.cell[upper]];
      } else {
        const ConvexPolygon outline = pixel_at(grid, u, v);
        gray = integral(facet, outline) / outline.area();
      }
      image[pixel] = static_cast<Gray16>(std::lround(gray * 256.0));
    }
  }
}

}  // namespace pilotfish::sim
