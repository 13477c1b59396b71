#include "level_field.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>

// Light changes smoothly, but not evenly: a reflection is bright in its middle. The level of a colour in a cell is the
// value there of the paraboloid
//
//   g(i, j) = a + b i + c j + d i^2 + e i j + f j^2,    i, j in cells from here,
//
// that fits the grays of the cells of that colour around it best, weighted by their distance. A mean of them would be
// too dark in the middle of a reflection: black cells there were then taken for white ones. Slopes and curvatures are
// expected to be small; where few cells are known they stay so.

namespace pilotfish::vision {
namespace {

constexpr int kReach = 3;  ///< cells farther away do not count
/// What is expected of slopes and curvatures: they count as so many cells without any.
constexpr float kSlope = 0.02F, kCurvature = 0.1F;

/// The weighted mean of 3 x 3 pixels; negative outside the picture.
float gray_at(const ImageView& image, const Eigen::Vector2d& pixel) {
  if (!(pixel.x() >= 0.5 && pixel.y() >= 0.5 && pixel.x() < image.width - 1.5 && pixel.y() < image.height - 1.5))
    return -1.0F;
  const Eigen::Vector2d from_rim = pixel + Eigen::Vector2d(0.5, 0.5);
  const auto u = static_cast<std::ptrdiff_t>(from_rim.x()), v = static_cast<std::ptrdiff_t>(from_rim.y());
  const std::uint8_t* middle = image.data + v * image.stride_bytes + u;
  const auto row = [](const std::uint8_t* p) { return p[-1] + 2 * p[0] + p[1]; };
  return static_cast<float>(row(middle - image.stride_bytes) + 2 * row(middle) + row(middle + image.stride_bytes)) /
         16.0F;
}

/// The paraboloid through the grays of one colour.
struct Surface {
  using Terms = Eigen::Matrix<float, 6, 1>;
  Eigen::Matrix<float, 6, 6> information = prior();
  Terms gradient = Terms::Zero();
  float weights = 0.0F;

  static Eigen::Matrix<float, 6, 6> prior() {
    Terms diagonal;
    diagonal << 1e-9F, kSlope, kSlope, kCurvature, kCurvature, kCurvature;
    return diagonal.asDiagonal();
  }

  void add(int i, int j, float weight, float gray) {
    const auto x = static_cast<float>(i), y = static_cast<float>(j);
    Terms terms;
    terms << 1.0F, x, y, x * x, x * y, y * y;
    information.noalias() += weight * terms * terms.transpose();
    gradient += weight * gray * terms;
    weights += weight;
  }

  /// Its level at i = j = 0, as a camera shows it.
  double here() const {
    const float level = information.ldlt().solve(gradient)[0];
    return std::clamp(static_cast<double>(level), 0.0, 255.0);
  }
};

}  // namespace

bool LevelField::measure(const ImageView& image, const CameraModel& camera, const TagWarp& warp,
                         const TagPattern& pattern, double reach_cells, bool without_own) {
  side_ = pattern.cells - 2 * TagPattern::kMargin;
  cell_side_ = pattern.cell_side;
  if (side_ > kSide) return false;
  // By cell: its gray, negative where it is not known, and its colour.
  std::array<float, static_cast<std::size_t>(kSide) * kSide> gray;
  std::array<bool, static_cast<std::size_t>(kSide) * kSide> white{};
  gray.fill(-1.0F);
  for (const TagPattern::Cell& known : pattern.known) {
    const int column = static_cast<int>(known.centre.x() / cell_side_ + 0.5 * side_);
    const int row = static_cast<int>(known.centre.y() / cell_side_ + 0.5 * side_);
    const std::size_t index = static_cast<std::size_t>(row) * kSide + column;
    // A ring may have been cut to half its width: its inner part is there in any case.
    const bool outermost = column == 0 || row == 0 || column == side_ - 1 || row == side_ - 1;
    const double inwards = outermost ? 1.0 - 0.4 / side_ : 1.0;
    gray[index] = gray_at(image, warp.pixel(camera, warp.flat(inwards * known.centre)));
    white[index] = known.white;
  }
  std::array<float, 2 * kReach * kReach + 1> weight{};
  for (std::size_t d2 = 0; d2 < weight.size(); ++d2)
    weight[d2] = static_cast<float>(std::exp(-0.5 * static_cast<double>(d2) / (reach_cells * reach_cells)));

  for (int row = 0; row < side_; ++row)
    for (int column = 0; column < side_; ++column) {
      Surface surface[2];
      for (int j = std::max(row - kReach, 0); j <= std::min(row + kReach, side_ - 1); ++j)
        for (int i = std::max(column - kReach, 0); i <= std::min(column + kReach, side_ - 1); ++i) {
          const std::size_t index = static_cast<std::size_t>(j) * kSide + i;
          const int d2 = (i - column) * (i - column) + (j - row) * (j - row);
          if (gray[index] < 0.0F || (without_own && d2 == 0)) continue;
          surface[white[index]].add(i - column, j - row, weight[d2], gray[index]);
        }
      Levels& levels = levels_[static_cast<std::size_t>(row) * kSide + column];
      const bool known = surface[0].weights > 1e-6F && surface[1].weights > 1e-6F;
      // Without contrast nothing can be read.
      levels = known ? Levels{surface[0].here(), surface[1].here()} : Levels{0.0, 0.0};
    }
  return true;
}

LevelField::Levels LevelField::at(const Eigen::Vector2d& tag) const {
  const double last = side_ - 1.0;
  const double x = std::clamp(tag.x() / cell_side_ + 0.5 * last, 0.0, last - 1e-6);
  const double y = std::clamp(tag.y() / cell_side_ + 0.5 * last, 0.0, last - 1e-6);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double a = x - column, b = y - row;
  const Levels &p = cell(column, row), &q = cell(column + 1, row), &r = cell(column, row + 1),
               &s = cell(column + 1, row + 1);
  const auto mixed = [&](double Levels::*level) {
    return (1 - b) * ((1 - a) * p.*level + a * q.*level) + b * ((1 - a) * r.*level + a * s.*level);
  };
  return {mixed(&Levels::black), mixed(&Levels::white)};
}

}  // namespace pilotfish::vision
