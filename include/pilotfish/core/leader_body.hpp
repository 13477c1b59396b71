#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// One tag on a robot. Its own frame: origin in the centre of the black square, x right and y down as one reads it, z
/// into the wall it hangs on (so that a tag seen head-on has the camera's axes).
struct BodyTag {
  PILOTFISH_PARAMETERS(BodyTag);
  PILOTFISH_PARAMETER(int, id, 0, 0, 65535, "number of the tag in its family");
  /// AprilTag's definition.
  PILOTFISH_PARAMETER(double, size_m, 0.16, 0.005, 5.0, "side of the black square");
  PILOTFISH_PARAMETER(Vector3, position_m, {}, -10.0, 10.0, "centre in the leader's base frame: forward, left, up");
  PILOTFISH_PARAMETER(double, facing_rad, kPi, -2 * kPi, 2 * kPi,
                      "direction it looks: 0 forward, 90 deg left, 180 deg rear");
  PILOTFISH_PARAMETER(double, tilt_rad, 0.0, -kPi / 2, kPi / 2, "positive: it looks up");
  PILOTFISH_PARAMETER(double, roll_rad, 0.0, -kPi, kPi, "turned clockwise, as one reads it");
};

/// oMt: tag frame to the frame o of the leader's base.
Eigen::Isometry3d body_from_tag(const BodyTag& tag);

/// The four corners of the black square in the leader's base frame [m], in AprilTag's order: bottom left, bottom right,
/// top right, top left, as one reads the tag.
std::array<Eigen::Vector3d, 4> corners_on_body(const BodyTag& tag);

/// The most tags a body may have: enough for two on each of six faces. The control loop's arrays are of this
/// size, so that it never allocates.
inline constexpr std::size_t kMaxTagsOnBody = 12;

/// A leader: the tags it wears and where. The poses of all of them refer to its base origin, between the wheels.
struct LeaderBody {
  std::string name = "leader";      ///< name of the leader, for people
  std::string family = "tag36h11";  ///< name of the AprilTag family of all its tags
  std::vector<BodyTag> tags;        ///< list of BodyTag, a copy

  const BodyTag* find(int id) const;  ///< nullptr if the body does not wear that id
  /// Throws ConfigError: no tag, more than kMaxTagsOnBody, an id twice, two tags in one place, a bad number.
  void validate() const;
};

}  // namespace pilotfish
PILOTFISH_API_END
