#include "corner_covariance.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::vision {
namespace {

/// How many times more the residuals move the tag than independent ones of the same size would. Light, a bent sheet, a
/// sharpener leave residuals that agree with their neighbours'. With g_c = sum of J_i r_i over the samples of a block
/// of the tag and e_c = A^-1 g_c, the pull of that block on the position, independent residuals of variance s^2 have
///
///   E[sum over blocks of e_c^T B^-1 e_c] = 8 s^2 (1 - 1 / blocks),   B = the position's part of A^-1.
///
/// At least 1: less than independent is luck.
double correlation_factor(const Rows& rows, const TemplateSamples& samples,
                          const Eigen::Matrix<double, kParameters, 8>& inverse, double noise) {
  constexpr int kBlocks = 5;
  // A sample in one piece, so that its sixteen numbers are added at once.
  const Eigen::Matrix<float, kParameters, Eigen::Dynamic, Eigen::ColMajor, kParameters, TemplateSamples::kCapacity>
      by_sample = rows.J.topRows(samples.count).transpose();
  Eigen::Matrix<float, kParameters, kBlocks * kBlocks> pull;
  pull.setZero();
  for (int i = 0; i < samples.count; ++i) {
    const auto block_of = [](float coordinate) {
      return std::clamp(static_cast<int>((coordinate + 1.25F) * (kBlocks / 2.5F)), 0, kBlocks - 1);
    };
    const int block = block_of(samples.row_y[i]) * kBlocks + block_of(samples.column_x[i]);
    pull.col(block) += rows.r[i] * by_sample.col(i);
  }
  const Eigen::Matrix<double, 8, kBlocks* kBlocks> moved = inverse.transpose() * pull.cast<double>();
  const Eigen::LDLT<Matrix8d> position(inverse.topRows<8>());
  const double sum = moved.cwiseProduct(position.solve(moved)).sum();
  const double factor = sum / (8.0 * noise * noise * (1.0 - 1.0 / (kBlocks * kBlocks)));
  return std::isfinite(factor) ? std::max(factor, 1.0) : 1.0;
}

/// Residuals that agree with their neighbours' are edges that lie elsewhere than the template's, and what displaces
/// them need not average out over the tag. [px^2], of one corner coordinate: such residuals, over the slope of the
/// ramp, contrast / sqrt(2 pi blur). Up to twice as much as independence allows is chance.
double residual_variance_px2(const Appearance& appearance, double noise, double factor) {
  const double systematic = noise * noise * std::max(0.0, 1.0 - 2.0 / factor);
  const double blur_px2 = 0.5 * (appearance.blur_u_px2 + appearance.blur_v_px2) + kSampleBlur_px2;
  return systematic * 2.0 * kPi * blur_px2 / std::max(appearance.contrast() * appearance.contrast(), 1.0);
}

}  // namespace

Matrix8d corner_covariance(const CameraModel& camera, const Fit& fit, const Task& task) {
  Parameters scale;
  const Eigen::LDLT<Normal> solver = scaled(task.sum.information, scale);
  Eigen::Matrix<double, kParameters, 8> unit = Eigen::Matrix<double, kParameters, 8>::Identity();
  unit = scale.asDiagonal() * solver.solve(scale.asDiagonal() * unit);
  Matrix8d J;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& corner = tag_corners()[i];
    const Eigen::Matrix2d pixel_from_g = fit.warp.pixel_jacobian(camera, fit.warp.flat(corner));
    for (int axis = 0; axis < 2; ++axis)
      J.row(2 * i + axis) = fit.warp.gradient(corner, pixel_from_g.row(axis).transpose());
  }
  const double factor = correlation_factor(task.rows, task.samples, unit, fit.noise);
  Matrix8d covariance = factor * fit.noise * fit.noise * J * unit.topRows<8>() * J.transpose();
  covariance.diagonal().array() += residual_variance_px2(fit.appearance, fit.noise, factor);
  return covariance;
}

}  // namespace pilotfish::vision
