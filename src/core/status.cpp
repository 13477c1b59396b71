#include "pilotfish/core/status.hpp"

namespace pilotfish {

std::string_view to_string(Status status) noexcept {
  switch (status) {
    case Status::searching: return "searching";
    case Status::tracking: return "tracking";
    case Status::coasting: return "coasting";
    case Status::lost: return "lost";
    case Status::stopped: return "stopped";
    case Status::invalid_input: return "invalid_input";
  }
  return "unknown";
}

std::string_view to_string(Reason reason) noexcept {
  switch (reason) {
    case Reason::none: return "";
    case Reason::no_tag_found: return "no tag in the picture";
    case Reason::no_tag_of_the_leader: return "no tag of the leader's body in the picture";
    case Reason::tag_refused: return "a tag of the leader was refused by a gate";
    case Reason::pose_refused: return "the leader's pose is not credible";
    case Reason::no_frame: return "no frame arrived in time";
    case Reason::frame_size_not_calibrated: return "the frame's size is not the calibration's";
    case Reason::frame_too_small: return "the frame is too small";
    case Reason::frame_too_large: return "the frame is too large";
    case Reason::frame_truncated: return "the frame has fewer bytes than its size promises";
    case Reason::frame_stride_invalid: return "the frame's stride is shorter than a row";
    case Reason::frame_time_not_advancing: return "the frame is not later than the one before";
    case Reason::frame_stale: return "the frame was too old when it arrived";
    case Reason::stop_requested: return "told to stop";
    case Reason::law_not_finite: return "the law's output was not finite";
    case Reason::tag_duplicate: return "a tag of the leader is seen twice";
    case Reason::tag_outside_frame: return "a tag of the leader is partly outside the picture";
    case Reason::tag_too_small: return "a tag of the leader is too small to be read";
    case Reason::tag_too_blurred: return "a tag of the leader is too blurred";
    case Reason::tag_size_implausible: return "a tag of the leader has a size that it cannot have at any range";
    case Reason::leader_behind_camera: return "the leader's pose is behind the camera or shows a tag's back";
    case Reason::leader_jumped: return "the leader is farther from where it was than it can have moved";
    case Reason::camera_frozen: return "the camera shows the same pixels again and again";
    case Reason::frame_time_implausible: return "the frame's time does not fit the time that has passed";
    case Reason::another_coordinator: return "another coordinator sends commands under this name";
    case Reason::internal_error: return "the program failed";
  }
  return "unknown";
}

}  // namespace pilotfish
