#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// What the coordinator is doing, always one of these. `tracking` and `coasting` may move it, `lost` turn it in place.
enum class Status {
  searching,      ///< running, the leader has not been seen since the start (or since a stop)
  tracking,       ///< the leader was measured in this very frame and the law drives
  coasting,       ///< not measured in this frame; the last command is held, for 100 ms at most
  lost,           ///< was tracked, has not been measured for longer than that: v = w = 0, unless it turns to search
  stopped,        ///< stopped by the setpoint: v = w = 0
  invalid_input,  ///< the frame cannot be used (size, format, time): v = w = 0 once coasting has run out
};

/// What a reason refers to.
enum class ReasonKind {
  observation,  ///< none, or none of use, in the picture: coasting, lost or searching
  input,        ///< the frame, or the program, cannot be used: Status::invalid_input
};

// clang-format off
/// The one list of reasons, X(name, kind, text): the enumeration, the text that is logged and published, the statuses,
/// the checks of what comes in and Python are made from it. The numbers are on the wire and in recordings: new ones go
/// to the end.
#define PILOTFISH_REASONS(X)                                                                                          \
  X(none, observation, "")                                                                                            \
  X(no_tag_found, observation, "no tag in the picture")                                                               \
  X(no_tag_of_the_leader, observation, "no tag of the leader's body in the picture")                                  \
  X(tag_refused, observation, "a tag of the leader was refused by a gate")                                            \
  X(pose_refused, observation, "the leader's pose is not credible")                                                   \
  X(no_frame, observation, "no frame arrived in time")                                                                \
  X(frame_size_not_calibrated, input, "the frame's size is not the calibration's")                                    \
  X(frame_too_small, input, "the frame is too small")                                                                 \
  X(frame_too_large, input, "the frame is too large")                                                                 \
  X(frame_truncated, input, "the frame has fewer bytes than its size promises")                                       \
  X(frame_stride_invalid, input, "the frame's stride is shorter than a row")                                          \
  X(frame_time_not_advancing, input, "the frame is not later than the one before")                                    \
  X(frame_stale, input, "the frame was too old when it arrived")                                                      \
  X(stop_requested, observation, "stop requested")                                                                    \
  X(law_not_finite, observation, "the law failed: it raised, or its output was not finite")                           \
  X(tag_duplicate, observation, "a tag of the leader is seen twice")                                                  \
  X(tag_outside_frame, observation, "a tag of the leader is partly outside the picture")                              \
  X(tag_too_small, observation, "a tag of the leader is too small to be read")                                        \
  X(tag_too_blurred, observation, "a tag of the leader is too blurred")                                               \
  X(tag_size_implausible, observation, "a tag of the leader has a size that it cannot have at any range")             \
  X(leader_behind_camera, observation, "the leader's pose is behind the camera or shows a tag's back")                \
  X(leader_jumped, observation, "the leader is farther from where it was than it can have moved")                     \
  X(camera_frozen, input, "the camera shows the same pixels again and again")                                         \
  X(frame_time_implausible, input, "the frame's time does not fit the time that has passed")                          \
  X(another_coordinator, input, "another coordinator sends commands under this name")                                 \
  X(internal_error, input, "the program failed")                                                                      \
  X(picture_repeated, observation, "the same picture as one before: nothing new is seen")                             \
  X(ranges_not_fresh, input, "no fresh ranges, without which it does not drive")                                      \
  X(obstacle_in_path, observation, "an obstacle is in the way")                                                       \
  X(turning_to_search, observation, "turning to where the leader was last seen")                                      \
  X(checking_another_leader, observation, "another leader is seen and checked before it is followed")                 \
  X(leader_changed, observation, "another leader is followed from here on")                                           \
  X(leader_upside_down, observation, "the leader stands on its head: is the camera mounted as camera.mounting says?")
// clang-format on

/// Why. One reason belongs to each status report; the text is what is logged and published.
enum class Reason {
#define PILOTFISH_REASON(name, kind, text) name,
  PILOTFISH_REASONS(PILOTFISH_REASON)
#undef PILOTFISH_REASON
};

/// A reason's description.
struct ReasonDescription {
  Reason reason;          ///< which one
  std::string_view name;  ///< the enumerator's; ends with a zero
  ReasonKind kind;        ///< what it refers to
  std::string_view text;  ///< a short sentence for people; ends with a zero
};

/// All of them, by number.
inline constexpr std::array kReasons = {
#define PILOTFISH_REASON(name, kind, text) ReasonDescription{Reason::name, #name, ReasonKind::kind, text},
    PILOTFISH_REASONS(PILOTFISH_REASON)
#undef PILOTFISH_REASON
};
#undef PILOTFISH_REASONS
static_assert(kReasons.size() <= 127, "a reason travels as int8_t");

std::string_view to_string(Status status) noexcept;
/// A short sentence for people, e.g. "no tag of the leader's body in the picture".
std::string_view to_string(Reason reason) noexcept;

}  // namespace pilotfish
PILOTFISH_API_END
