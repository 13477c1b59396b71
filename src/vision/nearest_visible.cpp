#include "pilotfish/vision/nearest_visible.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotfish/vision/tag_pattern.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kStep_m = 0.005, kFarthest_m = 5.0;

bool is_inside(const CameraModel& camera, const Eigen::Vector3d& point_c) {
  if (!(point_c.z() > 0.0)) return false;
  const Eigen::Vector2d pixel = project_normalized(camera, point_c.head<2>() / point_c.z());
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= camera.width - 1.0 && pixel.y() <= camera.height - 1.0;
}

bool is_visible(const CameraModel& camera, const TagPattern& pattern, double size_m, const Eigen::Isometry3d& cMt) {
  if (cMt.linear().col(2).dot(cMt.translation().normalized()) < kMinFacing) return false;
  int bits = 0, bits_inside = 0, cells_inside = 0;
  for (const TagPattern::Cell& cell : pattern.known) {
    const Eigen::Vector2d on_tag = 0.5 * size_m * cell.centre;
    const bool inside = is_inside(camera, cMt * Eigen::Vector3d(on_tag.x(), on_tag.y(), 0.0));
    cells_inside += inside;
    bits += cell.data;
    bits_inside += inside && cell.data;
  }
  return bits_inside >= kMinBitsInside * bits &&
         cells_inside >= kMinCellsInside * static_cast<double>(pattern.known.size());
}

}  // namespace

/// The tag's centre is put straight ahead of the camera, as far as the floor allows, and the leader turned until the
/// tag looks back: there more of it is inside the picture than beside it, or at an angle.
double nearest_visible_distance_m(const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body) {
  const Eigen::Isometry3d bMc = base_from_camera(mounting);
  const Eigen::Vector3d axis = bMc.linear().col(2);
  const double bearing_rad = std::atan2(axis.y(), axis.x());
  const Eigen::Vector2d ahead(std::cos(bearing_rad), std::sin(bearing_rad));
  const TagFamily family(body.family);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const BodyTag& tag : body.tags) {
    const TagPattern pattern = make_pattern(family, tag.id);
    const Eigen::Isometry3d oMt = body_from_tag(tag);
    const Eigen::Vector3d into_tag = oMt.linear().col(2);
    const double heading_rad = bearing_rad - std::atan2(into_tag.y(), into_tag.x());
    Eigen::Isometry3d bMo = Eigen::Isometry3d::Identity();
    bMo.linear() = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector2d from_leader = (bMo.linear() * oMt.translation()).head<2>();
    for (double depth_m = kStep_m; depth_m <= kFarthest_m; depth_m += kStep_m) {
      bMo.translation().head<2>() = bMc.translation().head<2>() + depth_m * ahead - from_leader;
      if (!is_visible(camera, pattern, tag.size_m, bMc.inverse() * bMo * oMt)) continue;
      nearest_m = std::min(nearest_m, bMo.translation().norm());
      break;
    }
  }
  return nearest_m;
}

}  // namespace pilotfish::vision
