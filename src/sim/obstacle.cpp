#include "pilotfish/sim/obstacle.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"
#include "random.hpp"

namespace pilotfish::sim {
namespace {

constexpr int kTries = 2000;  // for one obstacle
constexpr int kSides = 12;
constexpr double kGray = 150.0;

double drawn(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }

bool is_clear(const Obstacle& obstacle, const ObstacleField& field, const std::vector<Pose2>& clear,
              const std::vector<Obstacle>& others) {
  const auto near = [&](double x_m, double y_m, double distance_m) {
    return std::hypot(obstacle.x_m - x_m, obstacle.y_m - y_m) < distance_m;
  };
  return std::none_of(clear.begin(), clear.end(),
                      [&](const Pose2& pose) { return near(pose.x_m, pose.y_m, obstacle.radius_m + field.clear_m); }) &&
         std::none_of(others.begin(), others.end(), [&](const Obstacle& other) {
           return near(other.x_m, other.y_m, obstacle.radius_m + other.radius_m + field.gap_m);
         });
}

}  // namespace

std::vector<Obstacle> obstacles_of(const ObstacleField& field, std::uint64_t seed, const std::vector<Pose2>& clear,
                                   const std::vector<Obstacle>& others) {
  std::vector<Obstacle> all = others;
  Random random(seed_for(seed, "obstacles"));
  for (int i = 0; i < field.count; ++i) {
    int tries = 0;
    Obstacle obstacle;
    do {
      if (++tries > kTries)
        throw ConfigError("obstacle_field.count", std::to_string(field.count) + " do not fit, but " +
                                                      std::to_string(i) +
                                                      "; make the field larger, or clear_m and the radii less");
      obstacle.x_m = drawn(random, field.x_min_m, field.x_max_m);
      obstacle.y_m = drawn(random, field.y_min_m, field.y_max_m);
      obstacle.radius_m = drawn(random, field.radius_min_m, field.radius_max_m);
      obstacle.height_m = drawn(random, field.height_min_m, field.height_max_m);
    } while (!is_clear(obstacle, field, clear, all));
    all.push_back(obstacle);
  }
  return {all.begin() + static_cast<std::ptrdiff_t>(others.size()), all.end()};
}

/// Twelve sides as robots have them, lit from the right; the top is made of strips from each side to the one across,
/// which lie over each other in one plane and in one gray.
std::vector<Surface> surfaces_of(const Obstacle& obstacle) {
  std::vector<Surface> surfaces;
  const double half_side_m = obstacle.radius_m * std::tan(kPi / kSides), half_height_m = obstacle.height_m / 2.0;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * kPi * i / kSides;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0.0), right(-std::sin(angle), std::cos(angle), 0.0);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    Surface side;
    side.centre_m = obstacle.radius_m * out + half_height_m * up;
    side.half_a_m = half_side_m * right;  // as one looks at it from outside, its right; a x b points inwards
    side.half_b_m = -half_height_m * up;
    side.grays = {static_cast<float>(kGray * (1.0 - 0.25 * out.y()))};
    side.back_gray = -1.0F;
    surfaces.push_back(side);
    if (i >= kSides / 2) continue;
    Surface top;
    top.centre_m = obstacle.height_m * up;
    top.half_a_m = half_side_m * right;
    top.half_b_m = -obstacle.radius_m * out;
    top.grays = {static_cast<float>(kGray * 1.3)};
    top.back_gray = -1.0F;
    surfaces.push_back(top);
  }
  return surfaces;
}

/// In plan the line is within the circle from t to u, as shares of its length; over that stretch its lowest height must
/// be below the cylinder's.
bool hides(const Obstacle& obstacle, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const double dx = to.x() - from.x(), dy = to.y() - from.y();
  const double x = from.x() - obstacle.x_m, y = from.y() - obstacle.y_m;
  const double a = dx * dx + dy * dy, b = x * dx + y * dy;
  const double c = x * x + y * y - obstacle.radius_m * obstacle.radius_m;
  const double root = b * b - a * c;
  if (!(a > 0.0) || root < 0.0) return false;
  const double t = std::max((-b - std::sqrt(root)) / a, 0.0), u = std::min((-b + std::sqrt(root)) / a, 1.0);
  if (t > u) return false;
  const double rise = to.z() - from.z();
  return std::min(from.z() + t * rise, from.z() + u * rise) < obstacle.height_m;
}

}  // namespace pilotfish::sim
