#include "pilotfish/vision/tag_registration.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "corner_covariance.hpp"
#include "explanations.hpp"
#include "tag_warp.hpp"
#include "template_fit.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kShapeError_px = 0.2;     ///< see shape_sigma_px
constexpr double kNoisy_contrasts = 0.02;  ///< less is left of a flat tag by its shape, whatever that is
constexpr double kAgree = 2.0;  ///< residuals that move the tag so many times as much as independent ones are none

/// Side of a cell in pixels, along the axis of the tag that looks shorter.
double smallest_cell_px(const TagWarp& warp, const TagPattern& pattern) {
  const Eigen::Matrix2d J = warp.flat_jacobian(Eigen::Vector2d::Zero());
  return pattern.cell_side * std::min(J.col(0).norm(), J.col(1).norm());
}

/// The mean grays of the white and the black cells' middles.
bool measure_levels(const ImageView& image, const CameraModel& camera, const TagPattern& pattern, Fit& fit) {
  double sum[2] = {0.0, 0.0};
  int count[2] = {0, 0};
  for (const TagPattern::Cell& cell : pattern.known) {
    const Eigen::Vector2d pixel = fit.warp.pixel(camera, fit.warp.flat(cell.centre));
    if (!(pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < image.width - 0.5 && pixel.y() < image.height - 0.5))
      continue;
    const Eigen::Vector2d from_rim = pixel + Eigen::Vector2d(0.5, 0.5);
    const auto u = static_cast<std::ptrdiff_t>(from_rim.x()), v = static_cast<std::ptrdiff_t>(from_rim.y());
    sum[cell.white] += image.data[v * image.stride_bytes + u];
    ++count[cell.white];
  }
  if (count[0] == 0 || count[1] == 0) return false;
  fit.appearance.black = sum[0] / count[0];
  fit.appearance.white = sum[1] / count[1];
  return fit.appearance.contrast() > 0.0;
}

/// What is left of the blur's shape, which is not quite Gaussian, pulls all pixels of an edge the same way; the smaller
/// the cells, the less the edges' two flanks cancel. [px], of one corner coordinate, from renders of known geometry.
double shape_sigma_px(const Appearance& appearance, double cell_px) {
  const double blur_cells2 = 0.5 * (appearance.blur_u_px2 + appearance.blur_v_px2) / (cell_px * cell_px);
  return kShapeError_px * std::min(blur_cells2, 1.0);
}

}  // namespace

std::optional<Registration> register_tag(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                                         const Eigen::Matrix3d& nHt, const Appearance& start) noexcept {
  Fit fit{TagWarp(camera, nHt), start, 0.0, 0.0, std::nullopt};
  fit.appearance.black_slope.setZero();  // uneven light is measured anew
  fit.appearance.contrast_slope.setZero();
  if (!fit.warp.is_finite() || !measure_levels(image, camera, pattern, fit)) return std::nullopt;
  const double cell_px = smallest_cell_px(fit.warp, pattern);
  if (!(cell_px > 0.5)) return std::nullopt;

  Task task{image, camera, pattern, start, cell_px, {}, {}, {}};
  Fit near = fit;
  if (!settle(task, false, near) || !explains(near)) {
    near = fit;
    const bool settled = pull_in(task, near) && settle(task, true, near);
    if (!settled || !explains(near)) {
      const Fit* plain = settled ? &near : nullptr;
      const Fit from = settled ? near : fit;
      Fit anew = fit;
      if (settle_best({Cause::shadow, Cause::reflection, Cause::bend, Cause::close_cut, Cause::light}, task, fit.warp,
                      plain, from, near)) {
      } else if (settled && settle_bent(task, nullptr, anew) && explains(anew)) {
        near = anew;
      } else if (!settled || !settle(task, true, near)) {  // once more, for its normal equations
        return std::nullopt;
      }
    }
  }
  if (!(largest_move(fit.warp, near.warp) < 2.0 * cell_px)) return std::nullopt;
  CornerCovariance covariance = corner_covariance(camera, near, task);
  // What moves all of its parts one way is no noise: a shadow, a reflection, a bend.
  if (!near.warp.is_bent() && !near.light) {
    const Fit plain = near;
    const bool uneven = covariance.agreement > kAgree;
    const bool bent = near.noise > kNoisy_contrasts * near.appearance.contrast() && may_be_bent(task, plain);
    if (uneven ? settle_best({Cause::shadow, Cause::reflection, Cause::bend}, task, fit.warp, &plain, plain, near)
               : bent && settle_best({Cause::bend}, task, fit.warp, &plain, plain, near))
      covariance = corner_covariance(camera, near, task);
  }
  fit = near;
  fit.appearance = fit.mean_appearance();

  Registration found;
  found.nHt = fit.warp.nHt();
  found.bend = fit.warp.bend;
  found.corners_px = tag_corners_px(camera, fit.warp.tangent());
  found.covariance_px2 = covariance.px2;
  const double shape_px = shape_sigma_px(fit.appearance, cell_px);
  found.covariance_px2.diagonal().array() += shape_px * shape_px;
  found.appearance = fit.appearance;
  found.cell_px = smallest_cell_px(fit.warp, pattern);
  found.residual_rms = fit.noise;
  found.outlier_share = fit.outlier_share;
  found.pixels = task.sum.inliers;
  if (!found.covariance_px2.allFinite() || !found.nHt.allFinite()) return std::nullopt;
  return found;
}

}  // namespace pilotfish::vision
