#include "corner_covariance.hpp"

#include <algorithm>
#include <cmath>

#include "explanations.hpp"
#include "pilotfish/core/angles.hpp"

namespace pilotfish::vision {
namespace {

/// Residuals that move the tag so many times as much as independent ones show another shape than the template's. What
/// that does to corners that are extrapolated from it, they do not say.
constexpr double kMisfitFrom = 8.0;

/// How many times more the residuals move the tag than independent ones of the same size would. Light, a bent sheet, a
/// sharpener leave residuals that agree with their neighbours'. With g_c = sum of J_i r_i over the samples of a block
/// of the tag and e_c = A^-1 g_c, the pull of that block on the position, independent residuals of variance s^2 have
///
///   E[sum over blocks of e_c^T B^-1 e_c] = 8 s^2 (1 - 1 / blocks),   B = the position's part of A^-1.
///
/// At least 1: less than independent is luck.
template <int N>
double correlation_factor(const Rows& rows, const TemplateSamples& samples, const Eigen::Matrix<double, N, 8>& inverse,
                          double noise) {
  constexpr int kBlocks = 5;
  // A sample in one piece, so that its sixteen numbers are added at once.
  const Eigen::Matrix<float, N, Eigen::Dynamic, Eigen::ColMajor, N, TemplateSamples::kCapacity> by_sample =
      rows.J.leftCols<N>().topRows(samples.count).transpose();
  Eigen::Matrix<float, N, kBlocks * kBlocks> pull;
  pull.setZero();
  for (int i = 0; i < samples.count; ++i) {
    const auto block_of = [](float coordinate) {
      return std::clamp(static_cast<int>((coordinate + 1.25F) * (kBlocks / 2.5F)), 0, kBlocks - 1);
    };
    const int block = block_of(samples.row_y[i]) * kBlocks + block_of(samples.column_x[i]);
    pull.col(block) += rows.r[i] * by_sample.col(i);
  }
  const Eigen::Matrix<double, 8, kBlocks* kBlocks> moved = inverse.transpose() * pull.template cast<double>();
  const Eigen::LDLT<Matrix8d> position(inverse.template topRows<8>());
  const double sum = moved.cwiseProduct(position.solve(moved)).sum();
  const double factor = sum / (8.0 * noise * noise * (1.0 - 1.0 / (kBlocks * kBlocks)));
  return std::isfinite(factor) ? std::max(factor, 1.0) : 1.0;
}

/// Residuals that agree with their neighbours' are edges that lie elsewhere than the template's, and what displaces
/// them need not average out over the tag. [px^2], of one corner coordinate: such residuals, over the slope of the
/// ramp, contrast / sqrt(2 pi blur). Up to twice as much as independence allows is chance, unless something is there
/// that no model explains: then all of it may be.
double residual_variance_px2(const Appearance& appearance, double noise, double factor, bool explained) {
  const double systematic = noise * noise * (explained ? std::max(0.0, 1.0 - 2.0 / factor) : 1.0);
  const double blur_px2 = 0.5 * (appearance.blur_u_px2 + appearance.blur_v_px2) + kSampleBlur_px2;
  return systematic * 2.0 * kPi * blur_px2 / std::max(appearance.contrast() * appearance.contrast(), 1.0);
}

template <int N>
CornerCovariance covariance_of(const CameraModel& camera, const Fit& fit, const Task& task) {
  Eigen::Matrix<double, N, 1> scale;
  const Eigen::LDLT<NormalOf<N>> solver = scaled<N>(task.sum.information, scale);
  Eigen::Matrix<double, N, 8> unit = Eigen::Matrix<double, N, 8>::Identity();
  unit = scale.asDiagonal() * solver.solve(scale.asDiagonal() * unit);
  const TagWarp plane = fit.warp.tangent();
  Matrix8d J;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& corner = tag_corners()[i];
    const Eigen::Matrix2d pixel_from_g = plane.pixel_jacobian(camera, plane.flat(corner));
    for (int axis = 0; axis < 2; ++axis)
      J.row(2 * i + axis) = plane.gradient(corner, pixel_from_g.row(axis).transpose());
  }
  CornerCovariance covariance;
  covariance.agreement = correlation_factor<N>(task.rows, task.samples, unit, fit.noise);
  const double misfit = std::max(1.0, covariance.agreement / kMisfitFrom);
  covariance.px2 =
      misfit * covariance.agreement * fit.noise * fit.noise * J * unit.template topRows<8>() * J.transpose();
  // Pixel by pixel, noise alone leaves more than that.
  const bool explained = explains(fit) || task.cell_px < kDenseBelow_px;
  covariance.px2.diagonal().array() +=
      misfit * residual_variance_px2(fit.mean_appearance(), fit.noise, covariance.agreement, explained);
  return covariance;
}

}  // namespace

CornerCovariance corner_covariance(const CameraModel& camera, const Fit& fit, const Task& task) {
  if (fit.warp.is_bent()) return covariance_of<kBentParameters>(camera, fit, task);
  if (fit.light) return covariance_of<kShadedParameters>(camera, fit, task);
  return covariance_of<kFlatParameters>(camera, fit, task);
}

}  // namespace pilotfish::vision
