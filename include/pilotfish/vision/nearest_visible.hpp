#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/leader_body.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// A tag that is followed may be partly outside the picture, as long as these shares are inside: of its bits, and of
/// all its cells with those of the frame around them.
inline constexpr double kMinBitsInside = 0.6, kMinCellsInside = 0.5;
/// Cosine of the largest viewing angle at which a tag is followed.
inline constexpr double kMinFacing = 0.2;

/// The nearest distance [m] between the turning centres at which a leader can be followed at all, to 5 mm: one of its
/// tags, straight ahead of the camera and looking at it, has those shares in the picture. Nearer, the robot is blind.
/// Infinity if no tag is visible with 5 m or less in between, as with a camera that looks at the ceiling. All arguments
/// must be valid.
double nearest_visible_distance_m(const CameraModel& camera, const CameraMounting& mounting, const LeaderBody& body);

}  // namespace pilotfish::vision
PILOTFISH_API_END
