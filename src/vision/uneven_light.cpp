#include "pilotfish/vision/uneven_light.hpp"

#include <cmath>

namespace pilotfish::vision {

double UnevenLight::share_at(const Eigen::Vector2d& tag) const {
  if (shape == Shape::spot) {
    const double distance = (tag - Eigen::Vector2d(place[0], place[1])).norm() / place[2];
    return std::exp(-0.5 * distance * distance);
  }
  const double z = (std::cos(place[0]) * tag.x() + std::sin(place[0]) * tag.y() - place[1]) / place[2];
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

double UnevenLight::mean_share() const {
  constexpr int kAside = 8;
  double sum = 0.0;
  for (int column = 0; column < kAside; ++column)
    for (int row = 0; row < kAside; ++row)
      sum += share_at(Eigen::Vector2d(2.0 * column + 1.0, 2.0 * row + 1.0) / kAside - Eigen::Vector2d::Ones());
  return sum / (kAside * kAside);
}

}  // namespace pilotfish::vision
