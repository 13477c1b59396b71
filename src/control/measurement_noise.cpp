#include "pilotfish/control/measurement_noise.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"
#include "recent_samples.hpp"
#include "third_difference.hpp"

namespace pilotfish::control {
namespace {

constexpr double kMedianOfChiSquare = 0.4549364;  ///< one degree of freedom

/// From (along, across the line of sight, heading) to (x, y, heading).
Eigen::Matrix3d from_line_of_sight(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return (Eigen::Matrix3d() << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0).finished();
}

}  // namespace

void MeasurementNoise::add(const LeaderFix& fix) noexcept {
  if (!append_in_time(fixes_, fix, kLongestGap_s)) return;

  const auto [weight, norm2] = third_difference(fixes_);
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();
  Eigen::Matrix3d claimed = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    Eigen::Vector3d offset = fixes_[i].mean - fixes_[0].mean;  // the weights' sum is zero: only differences count
    offset(2) = wrap_angle(offset(2));
    residual += weight[i] * offset;
    claimed += weight[i] * weight[i] * fixes_[i].covariance;
  }
  const Eigen::Matrix3d turn = from_line_of_sight(fix.line_of_sight_rad).transpose();
  const Eigen::Vector3d r = turn * residual / std::sqrt(norm2);
  Sample sample{r.cwiseAbs2(), (turn * claimed * turn.transpose()).diagonal() / norm2};
  if (!sample.squared.allFinite() || !sample.claimed.allFinite()) return;
  if (samples_.full()) samples_.pop_front();
  samples_.push_back(sample);
  if (samples_.size() < kMinSamples) return;

  const auto median = [this](Eigen::Vector3d Sample::*of, int axis) {
    return quantile<kWindow>(samples_, 0.5, [of, axis](const Sample& each) { return (each.*of)(axis); });
  };
  const Eigen::Vector3d most(kMax_m * kMax_m, kMax_m * kMax_m, kMax_rad * kMax_rad);
  for (int axis = 0; axis < 3; ++axis) {
    const double beyond =
        median(&Sample::squared, axis) / kMedianOfChiSquare - kSubtracted * median(&Sample::claimed, axis);
    excess_variance_(axis) = std::clamp(beyond, 0.0, most(axis));
  }
}

Eigen::Matrix3d MeasurementNoise::excess_covariance(double line_of_sight_rad) const noexcept {
  const Eigen::Matrix3d turn = from_line_of_sight(line_of_sight_rad);
  return turn * excess_variance_.asDiagonal() * turn.transpose();
}

}  // namespace pilotfish::control
