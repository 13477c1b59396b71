#include "pilotfish/control/free_way.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::control {
namespace {

constexpr double kNever_m = std::numeric_limits<double>::infinity();
constexpr double kBeside = 0.03;    // cosine: 88 degrees to the side and more is beside
constexpr double kStraight = 1e-4;  // [1/m]; over a metre such a circle leaves the line by 0.05 mm

}  // namespace

/// Straight: the disc's centre is at (s, 0), and touches where (x - s)^2 + y^2 = r^2, so s = x - sqrt(r^2 - y^2).
///
/// On a circle of radius R around (0, R) the centre has turned by an angle t from (0, 0), and a point at distance q
/// from the circle's centre, at angle p counted likewise, is at
///
///   R^2 + q^2 - 2 R q cos(p - t)
///
/// from it, squared. That is r^2 first at t = p - acos((R^2 + q^2 - r^2) / 2 R q), if |R - q| < r; the way is R t.
///
/// A point inside the disc already may only be passed beside or left behind: nearer it may come by no more than beside
/// it, sin(acos(kBeside)) of its distance.
double free_way_m(const SurfacePoint& point, double curvature, double radius_m) noexcept {
  const double distance_m = std::hypot(point.x_m, point.y_m);
  if (distance_m <= radius_m && point.x_m > kBeside * distance_m) return 0.0;
  const double r = std::min(radius_m, std::sqrt(1.0 - kBeside * kBeside) * distance_m);
  const double x = point.x_m, y = curvature < 0.0 ? -point.y_m : point.y_m;
  if (std::abs(curvature) < kStraight) {
    if (x <= 0.0 || std::abs(y) >= r) return kNever_m;
    return std::max(x - std::sqrt(r * r - y * y), 0.0);
  }
  const double R = 1.0 / std::abs(curvature), q = std::hypot(x, R - y);
  if (std::abs(R - q) >= r || q <= 0.0) return kNever_m;
  double p = std::atan2(x, R - y);
  if (p < 0.0) p += 2.0 * kPi;
  const double touching = std::acos(std::clamp((R * R + q * q - r * r) / (2.0 * R * q), -1.0, 1.0));
  const double t = p - touching;
  return t >= 0.0 ? R * t : kNever_m;  // below 0: only after a whole turn
}

double free_way_m(const ObstacleView& view, double curvature, double radius_m) noexcept {
  double way_m = kNever_m;
  for (const SurfacePoint& point : view.points) way_m = std::min(way_m, free_way_m(point, curvature, radius_m));
  return way_m;
}

double free_way_towards_m(const ObstacleView& view, double direction_rad, double radius_m) noexcept {
  const double c = std::cos(direction_rad), s = std::sin(direction_rad);
  double way_m = kNever_m;
  for (const SurfacePoint& point : view.points) {
    const SurfacePoint turned{c * point.x_m + s * point.y_m, c * point.y_m - s * point.x_m};
    way_m = std::min(way_m, free_way_m(turned, 0.0, radius_m));
  }
  return way_m;
}

}  // namespace pilotfish::control
