#include "template_samples.hpp"

#include <algorithm>
#include <cmath>

namespace pilotfish::vision {
namespace {

constexpr double kGoldenSection = 0.6180339887498949;

void add(TemplateSamples& samples, const TagPattern& pattern, const Eigen::Vector2d& g, const Eigen::Vector2d& tag,
         double gray) {
  const int R = samples.reach;
  const auto cell_of = [&](double coordinate) {
    const int cell = static_cast<int>(coordinate / pattern.cell_side + 0.5 * pattern.cells);
    return std::clamp(cell, R, pattern.cells - 1 - R);
  };
  const int column = cell_of(tag.x()), row = cell_of(tag.y());
  const int i = samples.count++;
  samples.gu[i] = static_cast<float>(g.x());
  samples.gv[i] = static_cast<float>(g.y());
  samples.gray[i] = static_cast<float>(gray);
  if (samples.light != nullptr) {
    const LevelField::Levels levels = samples.light->at(tag);
    samples.black[i] = static_cast<float>(levels.black);
    samples.white[i] = static_cast<float>(levels.white);
  }
  samples.column_x[i] = static_cast<float>((column + 0.5 - 0.5 * pattern.cells) * pattern.cell_side);
  samples.row_y[i] = static_cast<float>((row + 0.5 - 0.5 * pattern.cells) * pattern.cell_side);
  const std::uint8_t* cell = pattern.colour.data() + static_cast<std::ptrdiff_t>(row - R) * pattern.cells + column - R;
  for (int j = 0, n = 0; j <= 2 * R; ++j, cell += pattern.cells)
    for (int k = 0; k <= 2 * R; ++k, ++n) samples.colour[n][i] = cell[k];
}

/// Fills the last eight: repeats of the last sample, which linearize() leaves out again.
void pad(TemplateSamples& samples) {
  if (samples.count == 0) return;
  const int last = samples.count - 1, R = samples.reach;
  for (int i = samples.count; i < samples.blocks() * static_cast<int>(Lanes::SizeAtCompileTime); ++i) {
    for (TemplateSamples::Column* column : {&samples.gu, &samples.gv, &samples.gray, &samples.column_x, &samples.row_y})
      (*column)[i] = (*column)[last];
    if (samples.light != nullptr) {
      samples.black[i] = samples.black[last];
      samples.white[i] = samples.white[last];
    }
    for (int n = 0; n < (2 * R + 1) * (2 * R + 1); ++n) samples.colour[n][i] = samples.colour[n][last];
  }
}

double smoothed(const ImageView& image, std::ptrdiff_t u, std::ptrdiff_t v) {
  const std::uint8_t* middle = image.data + v * image.stride_bytes + u;
  const auto row = [](const std::uint8_t* p) { return p[-1] + 2 * p[0] + p[1]; };
  return (row(middle - image.stride_bytes) + 2 * row(middle) + row(middle + image.stride_bytes)) / 16.0;
}

}  // namespace

void take_along_edges(const ImageView& image, const CameraModel& camera, const TagWarp& warp, const TagPattern& pattern,
                      double spread_px, int wanted, TemplateSamples& samples) {
  samples.count = 0;
  const int most = std::max(1, wanted / static_cast<int>(pattern.edges.size()));
  const bool bent = camera.has_distortion();
  int turn = 0;
  const double outermost = samples.inner_only ? 1.0 - 0.5 * pattern.cell_side : 2.0;
  for (const TagPattern::Edge& edge : pattern.edges) {
    if (edge.middle.cwiseAbs().maxCoeff() > outermost) continue;
    const Eigen::Vector2d g_middle = warp.flat(edge.middle);
    const Eigen::Matrix2d J = warp.flat_jacobian(edge.middle);
    const int along = edge.vertical ? 1 : 0;
    const double step_px = J.col(along).norm();  // per tag coordinate along the edge
    const double length_px = pattern.cell_side * step_px;
    const double across_px =
        std::abs(J.determinant()) / step_px;  // distance from the edge per tag coordinate across it
    // Over one cell the way to the picture is straight: good enough to choose pixels.
    const Eigen::Vector2d pixel_middle = warp.pixel(camera, g_middle);
    const Eigen::Matrix2d pixel_from_g = warp.pixel_jacobian(camera, g_middle);
    const Eigen::Matrix2d g_from_pixel = pixel_from_g.inverse();
    // Samples of 3 x 3 pixels that lie closer share noise: the fit would treat it as independent.
    const int count = std::clamp(static_cast<int>((length_px + 2.6) / 2.5), 1, most);
    for (int i = 0; i < count && samples.count < TemplateSamples::kCapacity; ++i) {
      // Away from the ends, where another edge may begin. Across, spread evenly over the ramp (by the golden section,
      // which leaves no pattern): its flanks determine the blur and the gray levels, its middle the place.
      Eigen::Vector2d offset = Eigen::Vector2d::Zero();
      offset[along] = pattern.cell_side * ((i + 0.5) / count - 0.5) * (1.0 - std::min(1.0 / length_px, 0.5));
      offset[1 - along] = spread_px * (2.0 * std::fmod(kGoldenSection * turn++, 1.0) - 1.0) / across_px;
      const Eigen::Vector2d pixel = pixel_middle + pixel_from_g * (J * offset);
      // Whole pixels, with one more all around. (A cast, not std::floor, which is a function call without SSE 4.1.)
      if (!(pixel.x() >= 0.5 && pixel.y() >= 0.5 && pixel.x() < image.width - 1.5 && pixel.y() < image.height - 1.5))
        continue;
      const Eigen::Vector2d from_rim = pixel + Eigen::Vector2d(0.5, 0.5);
      const auto u = static_cast<std::ptrdiff_t>(from_rim.x()), v = static_cast<std::ptrdiff_t>(from_rim.y());
      const Eigen::Vector2d nearest(static_cast<double>(u), static_cast<double>(v));
      // Where that pixel lies must be exact: without distortion it is; with it, one step of Newton's method is enough.
      Eigen::Vector2d g = g_middle + g_from_pixel * (nearest - pixel_middle);
      if (bent) g += g_from_pixel * (nearest - warp.pixel(camera, g));
      add(samples, pattern, g, edge.middle + offset, smoothed(image, u, v));
    }
  }
  pad(samples);
}

void take_pixels(const ImageView& image, const CameraModel& camera, const TagWarp& warp, const TagPattern& pattern,
                 TemplateSamples& samples) {
  samples.count = 0;
  const double reach = 1.0 + (samples.inner_only ? -0.5 : 0.5) * pattern.cell_side;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  const std::array<Eigen::Vector2d, 4> rim = tag_corners_px(camera, warp, reach);
  for (const Eigen::Vector2d& corner : rim) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  // A tag seen from the side is small one way only. Where it has more pixels than there is room for, the golden section
  // leaves some out everywhere.
  const double kept_share = (TemplateSamples::kCapacity - 16) / std::max(quadrilateral_area(rim), 1.0);
  int turn = 0;
  low = low.cwiseMax(Eigen::Vector2d::Zero());
  high = high.cwiseMin(Eigen::Vector2d(image.width - 1.0, image.height - 1.0));
  if (!low.allFinite() || !high.allFinite() || (high - low).maxCoeff() > 100.0) return;

  const Eigen::Matrix3d tag_from_flat = warp.matrix().inverse();
  for (double v = std::ceil(low.y()); v <= high.y(); ++v) {
    Eigen::Vector2d g = Eigen::Vector2d::Zero();
    for (double u = std::ceil(low.x()); u <= high.x(); ++u) {
      // Newton's method from the neighbour's place. Without distortion the first step is exact; with it, the map is
      // almost linear from pixel to pixel.
      for (int step = 0; step < (u == std::ceil(low.x()) ? 5 : 1); ++step)
        g += warp.pixel_jacobian(camera, g).inverse() * (Eigen::Vector2d(u, v) - warp.pixel(camera, g));
      const Eigen::Vector2d tag = warp.tag(tag_from_flat, g);
      if (!(tag.cwiseAbs().maxCoeff() <= reach) || samples.count >= TemplateSamples::kCapacity) continue;
      if (std::fmod(kGoldenSection * turn++, 1.0) >= kept_share) continue;
      add(samples, pattern, g, tag,
          image.data[static_cast<std::ptrdiff_t>(v) * image.stride_bytes + static_cast<std::ptrdiff_t>(u)]);
    }
  }
  pad(samples);
}

}  // namespace pilotfish::vision
