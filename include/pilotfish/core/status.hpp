#pragma once

#include <string_view>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// What the coordinator is doing. Exactly one holds at any time; only `tracking` and `coasting` may move the robot.
enum class Status {
  searching,      ///< running, the leader has not been seen since the start (or since a stop)
  tracking,       ///< the leader was measured in this very frame and the law drives
  coasting,       ///< not measured in this frame; the last command is held, for 100 ms at most
  lost,           ///< was tracked, has not been measured for longer than that: v = w = 0
  stopped,        ///< told to stand still by the setpoint: v = w = 0
  invalid_input,  ///< the frame cannot be used (size, format, time): v = w = 0 once coasting has run out
};

/// Why. One reason belongs to each status report; the text is what is logged and published.
enum class Reason {
  none,                       ///< nothing to explain
  no_tag_found,               ///< no tag of the family in the picture
  no_tag_of_the_leader,       ///< tags, but none with an id of the leader's body
  tag_refused,                ///< a tag of the leader, refused by a gate (hamming, margin, residual)
  pose_refused,               ///< corners accepted, but the pose is not credible (reprojection error, range, behind)
  no_frame,                   ///< no frame arrived in time
  frame_size_not_calibrated,  ///< the frame's size is not the calibration's
  frame_too_small,            ///< below the smallest size a detector can take
  frame_too_large,            ///< above the largest size a detector can take
  frame_truncated,            ///< fewer bytes than width, height and stride promise
  frame_stride_invalid,       ///< stride shorter than a row
  frame_time_not_advancing,   ///< utime not later than the frame before
  frame_stale,                ///< older than the age limit when it arrived
  stop_requested,             ///< setpoint.run is false
  law_not_finite,             ///< a NaN or an infinity was caught behind the law
  tag_duplicate,              ///< a tag of the leader, seen twice: none of the two is accepted
  tag_outside_frame,          ///< a tag of the leader, partly outside the picture
  tag_too_small,              ///< a tag of the leader, too small to be read
  tag_too_blurred,            ///< a tag of the leader, too blurred to be accepted
  tag_size_implausible,       ///< a tag of the leader, larger or smaller than it can be at any range that is accepted
  leader_behind_camera,       ///< the pose puts a tag behind the camera or shows its back
  leader_jumped,              ///< farther from where it was than anything can have moved
  camera_frozen,              ///< the same pixels again and again, where a sensor would show noise
  frame_time_implausible,     ///< the stamp does not fit the time that has passed here
  another_coordinator,        ///< somebody else sends commands under this robot's name
  internal_error,             ///< an exception left the loop
};

std::string_view to_string(Status status) noexcept;
/// A short sentence for people, e.g. "no tag of the leader's body in the picture".
std::string_view to_string(Reason reason) noexcept;

}  // namespace pilotfish
PILOTFISH_API_END
