#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// A robot's appearance: a box, and tags on it or beside it. Grays are in [0, 255].
struct RobotBody {
  LeaderBody leader{"", "tag36h11", {}};  ///< may be without tags
  PILOTFISH_PARAMETERS(RobotBody);
  PILOTFISH_PARAMETER(Vector3, box_size_m, {}, 0.0, 10.0, "length, width, height; any of them zero: no box");
  PILOTFISH_PARAMETER(Vector3, box_position_m, {}, -10.0, 10.0, "centre of the box in the robot's base frame");
  PILOTFISH_PARAMETER(double, box_gray, 110.0, 0.0, 255.0, "of its rear and front; other sides are brighter or darker");
  PILOTFISH_PARAMETER(double, white_gray, 220.0, 0.0, 255.0, "of the tags' paper");
  PILOTFISH_PARAMETER(double, black_gray, 30.0, 0.0, 255.0, "of the tags' ink");
};

/// A flat rectangle that can be seen: a tag's sheet of paper, or a face of the box. All vectors are in the
/// base frame of the robot that wears it. As one reads it, a points to the right and b down, so a x b points
/// into the wall.
struct Surface {
  /// Of a rectangle: its centre and half its sides, in the body's frame [m].
  Eigen::Vector3d centre_m, half_a_m, half_b_m;
  int cells = 1;             ///< the pattern has cells x cells equal fields
  std::vector<float> grays;  ///< of the fields, row by row from the top left
  float back_gray = 0.0F;    ///< seen from behind; negative: cannot be seen from there
  bool is_sheet = false;     ///< lies on other surfaces: hides a wall that is up to kSheetClearance_m nearer
};

inline constexpr double kSheetClearance_m = 0.005;

/// The faces of the box, and every tag as a sheet: for a tag36h11, 10 x 10 cells with the white quiet zone
/// around the black square of 8 x 8. Throws ConfigError if libapriltag has no such family or the family has no such id.
std::vector<Surface> surfaces_of(const RobotBody& body);

}  // namespace pilotfish::sim
PILOTFISH_API_END
