#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/vision/tag_tracker.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// The nearest distance [m] between the turning centres at which the tracker can follow its leader at all, to 5 mm: one
/// of the tags, straight ahead of the camera and looking at it, has TagTracker's kMinBitsInside and kMinCellsInside in
/// the picture. Nearer, the robot is blind. Infinity if no tag is visible with 5 m or less in between, as with a camera
/// that looks at the ceiling. The mounting must be valid.
double nearest_visible_distance_m(const TagTracker& tracker, const CameraMounting& mounting);

}  // namespace pilotfish::vision
PILOTFISH_API_END
