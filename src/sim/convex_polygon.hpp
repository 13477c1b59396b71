#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace pilotfish::sim {

/// A line a x + b y + c = 0 of the plane; its positive side is where the left hand side is >= 0.
struct Line2 {
  double a, b, c;
  double at(double x, double y) const { return a * x + b * y + c; }
  Line2 operator-() const { return {-a, -b, -c}; }
};

/// A small convex polygon: a pixel, or a piece that lines have cut off it. Each cut adds one corner at most.
struct ConvexPolygon {
  static constexpr int kMaxCorners = 12;
  int size = 0;
  std::array<double, kMaxCorners> x, y;

  void add(double px, double py) {
    if (size == kMaxCorners) return;  // needs eight lines through one pixel, all round one piece
    x[static_cast<std::size_t>(size)] = px;
    y[static_cast<std::size_t>(size)] = py;
    ++size;
  }
  double area() const {  // shoelace, relative to a corner so that nothing cancels
    double twice = 0.0;
    for (std::size_t i = 1; i + 1 < static_cast<std::size_t>(size); ++i)
      twice += (x[i] - x[0]) * (y[i + 1] - y[0]) - (x[i + 1] - x[0]) * (y[i] - y[0]);
    return std::abs(twice) / 2.0;
  }
};

/// On which side of a line a polygon lies.
enum class Side { positive, negative, both };

/// Cuts along the line. `positive` and `negative` become the two parts if it lies on both sides, else they are not
/// touched: most polygons are cut by few lines, and copies cost more than the test. The polygon must not be empty.
inline Side cut(const ConvexPolygon& polygon, const Line2& line, ConvexPolygon& positive, ConvexPolygon& negative) {
  const auto count = static_cast<std::size_t>(polygon.size);
  std::array<double, ConvexPolygon::kMaxCorners> side;
  double lowest = INFINITY, highest = -INFINITY;
  for (std::size_t i = 0; i < count; ++i) {
    side[i] = line.at(polygon.x[i], polygon.y[i]);
    lowest = std::min(lowest, side[i]);
    highest = std::max(highest, side[i]);
  }
  if (lowest >= 0.0) return Side::positive;
  if (highest <= 0.0) return Side::negative;
  positive.size = negative.size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = i + 1 == count ? 0 : i + 1;
    (side[i] >= 0.0 ? positive : negative).add(polygon.x[i], polygon.y[i]);
    if ((side[i] >= 0.0) == (side[next] >= 0.0)) continue;
    const double t = side[i] / (side[i] - side[next]);
    const double px = polygon.x[i] + t * (polygon.x[next] - polygon.x[i]);
    const double py = polygon.y[i] + t * (polygon.y[next] - polygon.y[i]);
    positive.add(px, py);
    negative.add(px, py);
  }
  return Side::both;
}

}  // namespace pilotfish::sim
