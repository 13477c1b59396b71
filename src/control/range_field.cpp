#include "pilotfish/control/range_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {
namespace {

constexpr double kTouching_m = 0.05;    // nearer to the turning centre than any surface outside of a robot
constexpr double kWithin = 1.0 - 1e-6;  // the edge of a cone that is the border of two sectors is in the cone's own

std::size_t sector_of(double direction_rad) noexcept {
  const double turned = wrap_angle(direction_rad) / kSector_rad + static_cast<double>(kSectors) / 2.0;
  return static_cast<std::size_t>(std::max(turned, 0.0)) % kSectors;
}

/// The pose `motion` ahead of `pose`.
Pose2 composed(const Pose2& pose, const Pose2& motion) noexcept {
  const double c = std::cos(pose.heading_rad), s = std::sin(pose.heading_rad);
  return {pose.x_m + c * motion.x_m - s * motion.y_m, pose.y_m + s * motion.x_m + c * motion.y_m,
          pose.heading_rad + motion.heading_rad};
}

/// Whether a disc stands in the cone of a reading, and no nearer than it. Its nearest point in the cone lies towards
/// its centre, at rho - r; if that direction is outside the cone by delta, on the cone's edge, a ray that passes the
/// centre at rho sin(delta) and enters at rho cos(delta) - sqrt(r^2 - rho^2 sin^2(delta)), if at all.
bool explains(const Disc& disc, const Pose2& origin, double direction_rad, double half_rad, double range_m) noexcept {
  const double x = disc.x_m - origin.x_m, y = disc.y_m - origin.y_m, rho = std::hypot(x, y), r = disc.radius_m;
  if (rho <= r) return true;
  const double off_rad = std::abs(wrap_angle(std::atan2(y, x) - direction_rad)) - half_rad;
  if (off_rad <= 0.0) return range_m >= rho - r;
  const double across_m = rho * std::sin(off_rad);
  if (off_rad >= kPi / 2.0 || across_m > r) return false;
  return range_m >= rho * std::cos(off_rad) - std::sqrt(r * r - across_m * across_m);
}

}  // namespace

Pose2 motion_between(const Pose2& before, const Pose2& after) noexcept {
  const double c = std::cos(before.heading_rad), s = std::sin(before.heading_rad);
  const double x = after.x_m - before.x_m, y = after.y_m - before.y_m;
  return {c * x + s * y, c * y - s * x, after.heading_rad - before.heading_rad};
}

bool ObstacleView::covers(double direction_rad, double half_rad) const noexcept {
  const int steps = std::min(static_cast<int>(std::ceil(half_rad / kSector_rad)), static_cast<int>(kSectors) / 2);
  for (int i = -steps; i <= steps; ++i)
    if (!covered[sector_of(direction_rad + i * kSector_rad)]) return false;
  return true;
}

/// A scan that was taken a little before or after the present: the robot was where it gets to, or came from, with its
/// present twist. A direction without a reading keeps the one before, for as long as that is fresh.
void RangeField::add(const RangeScan& scan, const Twist& own, std::int64_t present_utime) noexcept {
  if (scan.ranges_m.size() != readings_.size()) {
    readings_.clear();
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) readings_.push_back({});
  }
  const Pose2 taken_at = move_along_arc(here_, own, seconds_between(present_utime, scan.utime));
  for (std::size_t i = 0; i < readings_.size(); ++i) {
    const auto range_m = static_cast<double>(scan.ranges_m[i]);
    if (range_m < 0.0) continue;
    readings_[i] = {range_m, scan.first_rad + static_cast<double>(i) * scan.step_rad, taken_at, scan.utime};
  }
  utime_ = scan.utime;
  step_rad_ = std::abs(scan.step_rad);
}

void RangeField::moved(const Pose2& before, const Pose2& after) noexcept {
  here_ = composed(here_, motion_between(before, after));
}

void RangeField::clear() noexcept { *this = RangeField{}; }

bool RangeField::fresh_at(std::int64_t utime, double max_age_s) const noexcept {
  return utime_ && seconds_between(*utime_, utime) <= max_age_s;
}

/// A reading of next to nothing says that something touches the robot. It is not moved along with the robot: that would
/// bring the surface to its other side, and what is inside the robot already may be left behind.
///
/// A ray looks into one sector; into those beside it as well where the next ray is no farther than a sector is wide, so
/// that no sector between two such rays is missed by rounding.
///
/// A cone's reading says that the nearest surface in it is so far away, and not where across it: the worst for whoever
/// may pass there is everywhere, so the whole arc is a surface. Of each sector the nearest distance counts, in its
/// middle: that is a degree off at most, and a mirrored world stays one.
ObstacleView RangeField::view(const RangeReadingModel& model, std::int64_t utime, const Pose2& from,
                              const Disc* explained) const noexcept {
  std::array<double, kSectors> nearest_m;
  nearest_m.fill(std::numeric_limits<double>::infinity());
  ObstacleView view;
  const Pose2 there = composed(here_, from);
  const double half_rad = std::max(model.cone_rad, kSector_rad) / 2.0;
  const int steps = std::max(1, static_cast<int>(std::ceil(half_rad / kSector_rad)));
  const bool dense = model.cone_rad >= kSector_rad || step_rad_ <= kSector_rad / kWithin;
  for (const Reading& reading : readings_) {
    if (reading.range_m < 0.0 || seconds_between(reading.utime, utime) > model.max_age_s) continue;
    const bool touches = reading.range_m < kTouching_m;
    const double range_m = touches ? kTouching_m : reading.range_m;
    Pose2 origin = motion_between(there, reading.taken_at);
    if (touches) origin.x_m = origin.y_m = 0.0;
    const bool is_known = explained != nullptr &&
                          explains(*explained, origin, origin.heading_rad + reading.direction_rad, half_rad, range_m);
    for (int i = -steps; i <= steps; ++i) {
      const double direction_rad = origin.heading_rad + reading.direction_rad + kWithin * half_rad * i / steps;
      if (i == 0 || dense) view.covered.set(sector_of(direction_rad));
      if (is_known || range_m >= model.max_range_m) continue;
      const SurfacePoint point{origin.x_m + range_m * std::cos(direction_rad),
                               origin.y_m + range_m * std::sin(direction_rad)};
      double& nearest = nearest_m[sector_of(std::atan2(point.y_m, point.x_m))];
      nearest = std::min(nearest, std::hypot(point.x_m, point.y_m));
    }
  }
  for (std::size_t i = 0; i < kSectors; ++i) {
    if (!std::isfinite(nearest_m[i])) continue;
    const double middle_rad = (static_cast<double>(i) + 0.5) * kSector_rad - kPi;
    view.points.push_back({nearest_m[i] * std::cos(middle_rad), nearest_m[i] * std::sin(middle_rad)});
  }
  return view;
}

}  // namespace pilotfish::control
