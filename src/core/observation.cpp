#include "pilotfish/core/observation.hpp"

#include <cmath>

namespace pilotfish {

RelativePose relative_pose(const Eigen::Isometry3d& bMo) {
  const Eigen::Vector3d origin = bMo.translation();
  const Eigen::Vector3d forward = bMo.linear().col(0);  // the leader's x axis, seen from the coordinator's base
  return {std::hypot(origin.x(), origin.y()), std::atan2(origin.y(), origin.x()), std::atan2(forward.y(), forward.x())};
}

std::string_view to_string(FoundBy found_by) noexcept {
  switch (found_by) {
    case FoundBy::track: return "track";
    case FoundBy::region: return "region";
    case FoundBy::frame: return "frame";
  }
  return "unknown";
}

}  // namespace pilotfish
