#include "pilotfish/control/own_motion_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pilotfish/core/utime.hpp"
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
  if (!places_.empty()) {
    const double passed_s = seconds_between(places_.back().utime, utime);
    if (!(passed_s > 0.0) || passed_s > kLongestGap_s) places_.clear();
  }
  if (places_.full()) places_.pop_front();
  places_.push_back({utime, leader_m});
  if (!places_.full()) return;

  const Eigen::Vector2d line_of_sight(std::cos(line_of_sight_rad), std::sin(line_of_sight_rad));
  const Difference near = difference(1, line_of_sight), far = difference(kStride, line_of_sight);
  if (!std::isfinite(near.squared_m2 + near.walk_s + far.squared_m2 + far.walk_s)) return;
  if (samples_.full()) samples_.pop_front();
  samples_.push_back({near.squared_m2, near.walk_s, far.squared_m2, far.walk_s});
  if (samples_.size() < kFewest) return;

  const auto quantile = [this](double Sample::*of, double share) {
    std::array<double, kWindow> values{};
    std::size_t count = 0;
    for (const Sample& each : samples_) values[count++] = each.*of;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(count));
    std::nth_element(values.begin(), at, values.begin() + static_cast<std::ptrdiff_t>(count));
    return *at;
  };
  const double far_m2 = quantile(&Sample::far_m2, kQuantile) / kQuantileOfChiSquare;
  const double near_m2 = quantile(&Sample::near_m2, kQuantile) / kQuantileOfChiSquare;
  const double beyond_m2 = far_m2 - kMargin * near_m2;
  const double walk_s = quantile(&Sample::far_s, 0.5) - kMargin * quantile(&Sample::near_s, 0.5);
  sigma_ = beyond_m2 > 0.0 && walk_s > 0.0 ? std::min(std::sqrt(beyond_m2 / walk_s), kMax) : 0.0;
}

}  // namespace pilotfish::control
