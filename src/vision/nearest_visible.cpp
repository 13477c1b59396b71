#include "pilotfish/vision/nearest_visible.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "is_inside.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kStep_m = 0.005, kFarthest_m = 5.0;

bool is_in_view(const CameraModel& camera, const Eigen::Vector3d& point_c) {
  if (!(point_c.z() > 0.0)) return false;
  return is_inside(project_normalized(camera, point_c.head<2>() / point_c.z()), camera.width, camera.height);
}

bool is_visible(const CameraModel& camera, const TagPattern& pattern, double size_m, const Eigen::Isometry3d& cMt) {
  if (cMt.linear().col(2).dot(cMt.translation().normalized()) < TagTracker::kMinFacing) return false;
  int bits = 0, bits_inside = 0, cells_inside = 0;
  for (const TagPattern::Cell& cell : pattern.known) {
    const Eigen::Vector2d on_tag = 0.5 * size_m * cell.centre;
    const bool inside = is_in_view(camera, cMt * Eigen::Vector3d(on_tag.x(), on_tag.y(), 0.0));
    cells_inside += inside;
    bits += cell.data;
    bits_inside += inside && cell.data;
  }
  return bits_inside >= TagTracker::kMinBitsInside * bits &&
         cells_inside >= TagTracker::kMinCellsInside * static_cast<double>(pattern.known.size());
}

}  // namespace

/// The tag's centre is put straight ahead of the camera, as far as the floor allows, and the leader turned until the
/// tag looks back: there more of it is inside the picture than beside it, or at an angle.
double nearest_visible_distance_m(const TagTracker& tracker, const CameraMounting& mounting) {
  const Eigen::Isometry3d bMc = base_from_camera(mounting);
  const Eigen::Vector3d axis = bMc.linear().col(2);
  const double bearing_rad = std::atan2(axis.y(), axis.x());
  const Eigen::Vector2d ahead(std::cos(bearing_rad), std::sin(bearing_rad));
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tracker.body().tags.size(); ++i) {
    const BodyTag& tag = tracker.body().tags[i];
    const Eigen::Isometry3d oMt = body_from_tag(tag);
    const Eigen::Vector3d into_tag = oMt.linear().col(2);
    const double heading_rad = bearing_rad - std::atan2(into_tag.y(), into_tag.x());
    Eigen::Isometry3d bMo = Eigen::Isometry3d::Identity();
    bMo.linear() = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector2d from_leader = (bMo.linear() * oMt.translation()).head<2>();
    for (double depth_m = kStep_m; depth_m <= kFarthest_m; depth_m += kStep_m) {
      bMo.translation().head<2>() = bMc.translation().head<2>() + depth_m * ahead - from_leader;
      if (!is_visible(tracker.camera(), tracker.pattern(i), tag.size_m, bMc.inverse() * bMo * oMt)) continue;
      nearest_m = std::min(nearest_m, bMo.translation().norm());
      break;
    }
  }
  return nearest_m;
}

}  // namespace pilotfish::vision
