#include "facets.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pilotfish::sim {
namespace {

constexpr double kNearest_m = 0.01;  // what is nearer to the optical centre is not drawn

using Outline = std::vector<Eigen::Vector3d>;

/// The part of a convex outline in space where plane . point >= 0 (Sutherland and Hodgman).
Outline clip(const Outline& outline, const Eigen::Vector3d& plane, double offset) {
  Outline inside;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector3d &here = outline[i], &next = outline[(i + 1) % outline.size()];
    const double s_here = plane.dot(here) - offset, s_next = plane.dot(next) - offset;
    if (s_here >= 0.0) inside.push_back(here);
    if ((s_here >= 0.0) != (s_next >= 0.0)) inside.push_back(here + (next - here) * (s_here / (s_here - s_next)));
  }
  return inside;
}

/// What of the rectangle is in front of the camera and in its field of view. Only there is the lens model
/// meant to hold: far outside, its polynomial folds back into the picture.
Outline visible_outline(const Eigen::Vector3d& centre, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const RayGrid& grid) {
  Outline outline = {centre - a - b, centre + a - b, centre + a + b, centre - a + b};
  outline = clip(outline, Eigen::Vector3d::UnitZ(), kNearest_m);
  outline = clip(outline, {1.0, 0.0, -grid.min_x}, 0.0);
  outline = clip(outline, {-1.0, 0.0, grid.max_x}, 0.0);
  outline = clip(outline, {0.0, 1.0, -grid.min_y}, 0.0);
  return clip(outline, {0.0, -1.0, grid.max_y}, 0.0);
}

/// Marks every pixel that the outline runs through, and finds their bounds. Steps of at most half a pixel,
/// and the pixels on both sides of a step that comes close to a border, leave none out.
void trace(const CameraModel& camera, const Outline& outline, Facet& facet, std::vector<std::uint8_t>& crossed) {
  facet.left = camera.width;
  facet.top = camera.height;
  facet.right = facet.bottom = 0;
  constexpr double reach_px = 0.3;
  const auto nearest = [](double at) { return static_cast<int>(at + (0.5 + 65536.0)) - 65536; };  // a fast floor()
  const auto mark = [&](int pu, int pv) {
    facet.left = std::min(facet.left, pu);
    facet.right = std::max(facet.right, pu + 1);
    facet.top = std::min(facet.top, pv);
    facet.bottom = std::max(facet.bottom, pv + 1);
    if (pu >= 0 && pu < camera.width && pv >= 0 && pv < camera.height)
      crossed[static_cast<std::size_t>(pv) * camera.width + pu] = 1;
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector3d &from = outline[i], &to = outline[(i + 1) % outline.size()];
    const Eigen::Vector2d ray = from.head<2>() / from.z(), end = to.head<2>() / to.z();
    const double length_px = ((end - ray).array() * Eigen::Array2d(camera.fx, camera.fy)).matrix().norm();
    const int steps = 1 + static_cast<int>(2.5 * length_px);
    for (int step = 0; step < steps; ++step) {
      const Eigen::Vector2d pixel = project_normalized(camera, ray + (end - ray) * (double(step) / steps));
      const int left = nearest(pixel.x() - reach_px), right = nearest(pixel.x() + reach_px);
      const int top = nearest(pixel.y() - reach_px), bottom = nearest(pixel.y() + reach_px);
      mark(left, top);
      if (right != left) mark(right, top);
      if (bottom != top) mark(left, bottom);
      if (right != left && bottom != top) mark(right, bottom);
    }
  }
  facet.left = std::clamp(facet.left, 0, camera.width);
  facet.right = std::clamp(facet.right, 0, camera.width);
  facet.top = std::clamp(facet.top, 0, camera.height);
  facet.bottom = std::clamp(facet.bottom, 0, camera.height);
}

/// A surface in the camera's frame.
struct Rectangle {
  Eigen::Vector3d centre, a, b;
  double facing;  ///< below 0: seen from behind; a x b points into the wall

  Rectangle(const VisibleBody& body, const Surface& surface)
      : centre(body.cMo * surface.centre_m),
        a(body.cMo.linear() * surface.half_a_m),
        b(body.cMo.linear() * surface.half_b_m),
        facing(a.cross(b).dot(centre)) {}
  bool can_be_seen(const Surface& surface) const {
    return facing != 0.0 && !(facing < 0.0 && surface.back_gray < 0.0F);
  }
};

/// Without the pixels that it may touch.
Facet facet_of(const Rectangle& rectangle, const Surface& surface) {
  Facet facet;
  Eigen::Matrix3d to_space;
  to_space << rectangle.a, rectangle.b, rectangle.centre;
  facet.from_ray = to_space.inverse();
  facet.sides = {facet.line(0, -1.0), -facet.line(0, 1.0), facet.line(1, -1.0), -facet.line(1, 1.0)};
  if (surface.is_sheet) facet.priority = 1.0 + kSheetClearance_m / std::max(rectangle.centre.z(), kSheetClearance_m);
  facet.cells = rectangle.facing > 0.0 ? surface.cells : 1;
  facet.grays = rectangle.facing > 0.0 ? surface.grays.data() : &surface.back_gray;
  return facet;
}

/// The corners of a box around a body, in the camera's frame.
using Corners = Eigen::Matrix<double, 3, 8>;
Corners corners_around(const VisibleBody& body) {
  Eigen::AlignedBox3d box;
  for (const Surface& surface : *body.surfaces) {
    const Eigen::Vector3d reach = surface.half_a_m.cwiseAbs() + surface.half_b_m.cwiseAbs();
    box.extend(surface.centre_m - reach);
    box.extend(surface.centre_m + reach);
  }
  Corners corners;
  for (int i = 0; i < 8; ++i) corners.col(i) = body.cMo * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
  return corners;
}

/// Whether visible_outline() of each surface within these corners is empty: all lie beyond one of its planes.
bool out_of_view(const Corners& corners, const RayGrid& grid) {
  constexpr double kRounding = 1e-9;
  const auto x = corners.row(0).array(), y = corners.row(1).array(), z = corners.row(2).array();
  return (z < kNearest_m - kRounding).all() || (x < grid.min_x * z - kRounding).all() ||
         (x > grid.max_x * z + kRounding).all() || (y < grid.min_y * z - kRounding).all() ||
         (y > grid.max_y * z + kRounding).all();
}

/// Whether the facet covers all that is within these corners, and more than a pixel around, and is nearer: what is
/// behind it contributes nothing to any pixel. All of this is linear in the ray (x, y, 1), so that it holds in between
/// if it holds at the corners.
bool covers(const Facet& facet, const Corners& corners, double margin) {
  const double nearest_m = corners.row(2).minCoeff();
  if (nearest_m < kNearest_m) return false;
  // 1 / depth times the priority of a sheet: the most that Facet::priority makes of it.
  const double nearness = 1.001 / nearest_m * (1.0 + kSheetClearance_m / nearest_m);
  const auto lowest = [margin](const Line2& line, double x, double y) {
    return line.at(x, y) - margin * (std::abs(line.a) + std::abs(line.b));
  };
  for (int i = 0; i < 8; ++i) {
    const double x = corners(0, i) / corners(2, i), y = corners(1, i) / corners(2, i);
    for (const Line2& side : facet.sides)
      if (lowest(side, x, y) <= 0.0) return false;
    if (lowest(facet.row(2), x, y) * facet.priority <= nearness) return false;
  }
  return true;
}

/// Those of the bodies that may contribute to the picture. A robot in a column sees all those before it, most of them
/// behind the next one: without this a picture's cost would grow with the number of robots in the world.
std::vector<bool> in_sight(const std::vector<VisibleBody>& bodies, const RayGrid& grid) {
  constexpr std::size_t kMaxCovers = 32;  // a bound for the cost; the nearest hide the most
  struct Near {
    double nearest_m;
    std::size_t body;
    Corners corners;
  };
  std::vector<Near> near_first;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].surfaces == nullptr || bodies[i].surfaces->empty()) continue;
    const Corners corners = corners_around(bodies[i]);
    if (!out_of_view(corners, grid)) near_first.push_back({corners.row(2).minCoeff(), i, corners});
  }
  std::sort(near_first.begin(), near_first.end(),
            [](const Near& one, const Near& other) { return one.nearest_m < other.nearest_m; });
  std::vector<bool> visible(bodies.size(), false);
  std::vector<Facet> covering;
  const double margin = 2.0 * grid.largest_step;
  for (const Near& near : near_first) {
    if (std::any_of(covering.begin(), covering.end(),
                    [&](const Facet& facet) { return covers(facet, near.corners, margin); }))
      continue;
    visible[near.body] = true;
    for (const Surface& surface : *bodies[near.body].surfaces) {
      if (covering.size() == kMaxCovers || near_first.size() == 1) break;
      const Rectangle rectangle(bodies[near.body], surface);
      const double reach_m = std::abs(rectangle.a.z()) + std::abs(rectangle.b.z());
      if (rectangle.can_be_seen(surface) && rectangle.centre.z() - reach_m > kNearest_m)
        covering.push_back(facet_of(rectangle, surface));
    }
  }
  return visible;
}

}  // namespace

std::vector<Facet> facets_of(const CameraModel& camera, const RayGrid& grid, const std::vector<VisibleBody>& bodies,
                             std::vector<std::uint8_t>& crossed) {
  std::vector<Facet> facets;
  const std::vector<bool> visible = in_sight(bodies, grid);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!visible[i]) continue;
    for (const Surface& surface : *bodies[i].surfaces) {
      const Rectangle rectangle(bodies[i], surface);
      if (!rectangle.can_be_seen(surface)) continue;
      const Outline outline = visible_outline(rectangle.centre, rectangle.a, rectangle.b, grid);
      if (outline.size() < 3) continue;
      Facet facet = facet_of(rectangle, surface);
      trace(camera, outline, facet, crossed);
      if (facet.left < facet.right && facet.top < facet.bottom) facets.push_back(facet);
    }
  }
  return facets;
}

}  // namespace pilotfish::sim
