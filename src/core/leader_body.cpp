#include "pilotfish/core/leader_body.hpp"

#include <algorithm>
#include <set>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/camera_model.hpp"

namespace pilotfish {
namespace {

/// Two prints cannot hang in one place and look the same way, whatever their sizes and however they are turned.
bool in_one_place(const BodyTag& one, const BodyTag& other) {
  constexpr double kSameDirection = 1.0 - 1e-12;  // of the cosine: 1e-6 rad
  const auto into_the_wall = [](const BodyTag& tag) -> Eigen::Vector3d { return body_from_tag(tag).linear().col(2); };
  return one.position_m == other.position_m && into_the_wall(one).dot(into_the_wall(other)) > kSameDirection;
}

}  // namespace

Eigen::Isometry3d body_from_tag(const BodyTag& tag) {
  // A camera that looks the way the tag hangs sees it upright, so the tag's axes are those of a camera whose optical
  // axis points INTO the wall: pan = facing + pi, tilt reversed. Turning the tag clockwise as read is that camera's
  // roll.
  CameraMounting reader;
  reader.position_m = tag.position_m;
  reader.pan_rad = tag.facing_rad + kPi;
  reader.tilt_rad = -tag.tilt_rad;
  reader.roll_rad = tag.roll_rad;
  return base_from_camera(reader);
}

std::array<Eigen::Vector3d, 4> corners_on_body(const BodyTag& tag) {
  const Eigen::Isometry3d oMt = body_from_tag(tag);
  const double h = tag.size_m / 2.0;
  return {oMt * Eigen::Vector3d(-h, h, 0), oMt * Eigen::Vector3d(h, h, 0), oMt * Eigen::Vector3d(h, -h, 0),
          oMt * Eigen::Vector3d(-h, -h, 0)};
}

const BodyTag* LeaderBody::find(int id) const {
  const auto found = std::find_if(tags.begin(), tags.end(), [id](const BodyTag& tag) { return tag.id == id; });
  return found == tags.end() ? nullptr : &*found;
}

void LeaderBody::validate() const {
  if (tags.empty()) throw ConfigError("leader.tags", "a leader needs at least one tag");
  if (tags.size() > kMaxTagsOnBody)
    throw ConfigError("leader.tags", std::to_string(tags.size()) + " tags; a leader may wear at most " +
                                         std::to_string(kMaxTagsOnBody));
  std::set<int> ids;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const std::string section = "leader.tags[" + std::to_string(i) + "]";
    check_ranges(tags[i], section);
    if (!ids.insert(tags[i].id).second)
      throw ConfigError(section + ".id", std::to_string(tags[i].id) + " is used twice; ids on one body must differ");
    for (std::size_t other = 0; other < i; ++other)
      if (in_one_place(tags[other], tags[i]))
        throw ConfigError(section + ".position_m", "tag " + std::to_string(tags[i].id) + " is where tag " +
                                                       std::to_string(tags[other].id) +
                                                       " is, and looks the same way; one of the two is elsewhere");
  }
}

}  // namespace pilotfish
