#include "tag_search.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/vision/tag_tracker.hpp"
#include "tag_warp.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kLiesWell = 0.8;       ///< a correlation at which the fit converges from here
constexpr int kMaxSteps = 12;           ///< in each direction
constexpr std::size_t kMaxCells = 160;  ///< of the largest family, with its rings: 12 x 12 and some

/// The middle of a cell in the picture, and its colour less the mean colour.
struct Probe {
  int u = 0, v = 0;
  float colour = 0.0F;
};
using Probes = BoundedVector<Probe, kMaxCells>;

/// The correlation coefficient of colours and grays with all probes moved by (du, dv).
double correlation(const ImageView& image, const Probes& probes, float colour_energy, int du, int dv) {
  float sum = 0.0F, sum_of_squares = 0.0F, covariance = 0.0F;
  for (const Probe& probe : probes) {
    const std::ptrdiff_t row = probe.v + dv;
    const auto gray = static_cast<float>(image.data[row * image.stride_bytes + probe.u + du]);
    sum += gray;
    sum_of_squares += gray * gray;
    covariance += probe.colour * gray;
  }
  const auto count = static_cast<float>(probes.size());
  const float gray_energy = sum_of_squares - sum * sum / count;
  return gray_energy > 1.0F ? covariance / std::sqrt(gray_energy * colour_energy) : 0.0;
}

}  // namespace

std::optional<Shift> find_shift(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                                const Eigen::Matrix3d& nHt, double search_px) noexcept {
  const TagWarp warp(camera, nHt);
  if (!warp.is_finite()) return std::nullopt;
  Probes probes;
  int left = image.width, right = -1, top = image.height, bottom = -1;
  float mean = 0.0F;
  for (const TagPattern::Cell& cell : pattern.known) {
    const Eigen::Vector2d pixel = warp.pixel(camera, warp.flat(cell.centre));
    if (!(pixel.cwiseAbs().maxCoeff() < 1e5)) return std::nullopt;
    const Probe probe{static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())),
                      cell.white ? 1.0F : 0.0F};
    // A tag that is leaving the picture is recognised by the cells that are in it.
    if (probe.u < 0 || probe.v < 0 || probe.u >= image.width || probe.v >= image.height) continue;
    left = std::min(left, probe.u);
    right = std::max(right, probe.u);
    top = std::min(top, probe.v);
    bottom = std::max(bottom, probe.v);
    mean += probe.colour;
    probes.push_back(probe);
    if (probes.full()) break;
  }
  if (probes.size() < TagTracker::kMinCellsInside * pattern.known.size()) return std::nullopt;
  mean /= static_cast<float>(probes.size());
  float colour_energy = 0.0F;
  for (Probe& probe : probes) {
    probe.colour -= mean;
    colour_energy += probe.colour * probe.colour;
  }
  const auto inside = [&](int du, int dv) {
    return left + du >= 0 && right + du < image.width && top + dv >= 0 && bottom + dv < image.height;
  };
  Shift best;
  best.correlation = inside(0, 0) ? correlation(image, probes, colour_energy, 0, 0) : -1.0;
  if (best.correlation > kLiesWell || !(search_px > 0.0)) return best;

  const Eigen::Matrix2d J = warp.flat_jacobian(Eigen::Vector2d::Zero());
  const double half_cell_px = 0.5 * pattern.cell_side * std::min(J.col(0).norm(), J.col(1).norm());
  const double step_px = std::max({1.0, half_cell_px, search_px / kMaxSteps});
  const int steps = static_cast<int>(search_px / step_px);
  for (int j = -steps; j <= steps; ++j)
    for (int i = -steps; i <= steps; ++i) {
      const int du = static_cast<int>(std::lround(i * step_px)), dv = static_cast<int>(std::lround(j * step_px));
      if (!inside(du, dv)) continue;
      const double found = correlation(image, probes, colour_energy, du, dv);
      if (found > best.correlation) best = {{du, dv}, found};
    }
  if (best.correlation < 0.0) return std::nullopt;
  return best;
}

}  // namespace pilotfish::vision
