#include "pilotfish/control/own_motion_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pilotfish/core/utime.hpp"
#include "recent_samples.hpp"
#include "third_difference.hpp"

namespace pilotfish::control {
namespace {

constexpr double kQuantile = 0.8, kQuantileOfChiSquare = 1.6423744;  ///< one degree of freedom

}  // namespace

OwnMotionNoise::Difference OwnMotionNoise::difference(std::size_t stride,
                                                      const Eigen::Vector2d& line_of_sight) const noexcept {
  std::array<Place, 4> four;
  for (std::size_t i = 0; i < 4; ++i) four[i] = places_[places_.size() - 1 - (3 - i) * stride];
  const auto [weight, norm2] = third_difference(four);
  double residual_m = 0.0, before = 0.0, walk = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    residual_m += weight[i] * line_of_sight.dot(four[i].leader_m - four[0].leader_m);
    before += weight[i];
    if (i < 3) walk += seconds_between(four[i].utime, four[i + 1].utime) * before * before;
  }
  return {residual_m * residual_m / norm2, walk / norm2};
}

void OwnMotionNoise::add(std::int64_t utime, const Eigen::Vector2d& leader_m, double line_of_sight_rad) noexcept {
  if (!append_in_time(places_, Place{utime, leader_m}, kLongestGap_s)) return;

  const Eigen::Vector2d line_of_sight(std::cos(line_of_sight_rad), std::sin(line_of_sight_rad));
  const Difference near = difference(1, line_of_sight), far = difference(kStride, line_of_sight);
  if (!std::isfinite(near.squared_m2 + near.walk_s + far.squared_m2 + far.walk_s)) return;
  if (samples_.full()) samples_.pop_front();
  samples_.push_back({near.squared_m2, near.walk_s, far.squared_m2, far.walk_s});
  if (samples_.size() < kMinSamples) return;

  const auto quantile_of = [this](double Sample::*of, double share) {
    return quantile<kWindow>(samples_, share, [of](const Sample& each) { return each.*of; });
  };
  const double far_m2 = quantile_of(&Sample::far_m2, kQuantile) / kQuantileOfChiSquare;
  const double near_m2 = quantile_of(&Sample::near_m2, kQuantile) / kQuantileOfChiSquare;
  const double beyond_m2 = far_m2 - kMargin * near_m2;
  const double walk_s = quantile_of(&Sample::far_s, 0.5) - kMargin * quantile_of(&Sample::near_s, 0.5);
  sigma_ = beyond_m2 > 0.0 && walk_s > 0.0 ? std::min(std::sqrt(beyond_m2 / walk_s), kMax) : 0.0;
}

}  // namespace pilotfish::control
