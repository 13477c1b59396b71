#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/status.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

// clang-format off
/// The one list of what vision refuses, X(member, name on the wire, reason that goes with it, text): the counters,
/// their names in a status, how a refusal is counted and explained, and Python are made from it.
#define PILOTFISH_REJECTION_COUNTERS(X)                                                                               \
  X(frames_invalid, "frames_invalid", none, "frames that cannot be read or are not of the calibration's size")        \
  X(hamming, "tag_hamming", tag_refused, "tags that read as something else")                                          \
  X(margin, "tag_margin", tag_refused, "tags with too little contrast")                                               \
  X(residual, "tag_residual", tag_refused, "tags of which something else explains too much")                          \
  X(foreign_id, "tag_foreign_id", no_tag_of_the_leader, "tags of the family that the leader does not wear")           \
  X(duplicate_id, "tag_duplicate_id", tag_duplicate,                                                                  \
    "ids seen twice in one picture: none of the two is accepted")                                                     \
  X(outside_frame, "tag_outside_frame", tag_outside_frame, "tags partly outside the picture")                         \
  X(too_small, "tag_too_small", tag_too_small, "tags too small to be read")                                           \
  X(too_blurred, "tag_too_blurred", tag_too_blurred, "tags too blurred to be accepted")                               \
  X(size, "tag_size", tag_size_implausible, "tags with a size that they cannot have at any range")                    \
  X(behind, "pose_behind", leader_behind_camera, "poses behind the camera, or that show a tag's back")                \
  X(jump, "pose_jump", leader_jumped, "leaders farther from where they were than anything can have moved")            \
  X(upside_down, "pose_upside_down", leader_upside_down, "leaders that stand on their heads")                         \
  X(pose, "pose", pose_refused, "corners that no credible pose explains")

/// Why a candidate tag is no measurement, X(name, text); each is counted by the counter of its name.
#define PILOTFISH_TAG_REFUSALS(X)                                                                                     \
  X(outside_frame, "partly outside the picture")                                                                      \
  X(too_small, "cells below min_cell_px")                                                                             \
  X(too_blurred, "blur above max_blur_cells")                                                                         \
  X(hamming, "it reads as something else")                                                                            \
  X(margin, "too little contrast")                                                                                    \
  X(residual, "it reads well, but something else explains too much of it")
// clang-format on

/// Why a candidate tag is no measurement.
enum class TagRefusal : std::uint8_t {
  not_found,  ///< nothing like it at that place
#define PILOTFISH_REFUSAL(name, text) name,
  PILOTFISH_TAG_REFUSALS(PILOTFISH_REFUSAL)
#undef PILOTFISH_REFUSAL
};

/// Everything that was refused since the start, by reason.
struct RejectionCounters {
#define PILOTFISH_COUNTER(member, name, reason, text) std::int64_t member = 0;
  PILOTFISH_REJECTION_COUNTERS(PILOTFISH_COUNTER)
#undef PILOTFISH_COUNTER

  /// A counter's description.
  struct Named {
    const char* name;                        ///< on the wire
    std::int64_t RejectionCounters::*count;  ///< which one
    const char* member;                      ///< the member's name
    Reason reason;                           ///< that the frame is reported with; Reason::none: one of several
    const char* text;                        ///< what it counts
  };
#define PILOTFISH_COUNTER(member, name, reason, text) +1  // NOLINT(bugprone-macro-parentheses): one of a sum
  static constexpr std::size_t kCount = 0 PILOTFISH_REJECTION_COUNTERS(PILOTFISH_COUNTER);  ///< so many there are
#undef PILOTFISH_COUNTER
  /// All of them, by name.
  static const std::array<Named, kCount>& all() noexcept;

  /// Counts a refused tag. Returns the reason for a status, or `otherwise` for a tag that was not found:
  /// something hides it, or it was never there, which is no refusal.
  Reason count(TagRefusal refusal, Reason otherwise) noexcept;
  /// Counts a refused pose.
  void count_pose(Reason refusal) noexcept;
};

/// A refusal's description.
struct TagRefusalDescription {
  TagRefusal refusal;                        ///< which one
  const char* name;                          ///< the enumerator's
  std::int64_t RejectionCounters::*counter;  ///< that counts it; none: it is not counted
  const char* text;                          ///< what was wrong
};

/// All of them, by number.
inline constexpr std::array kTagRefusals = {
    TagRefusalDescription{TagRefusal::not_found, "not_found", nullptr, "nothing like it at that place"},
#define PILOTFISH_REFUSAL(name, text) TagRefusalDescription{TagRefusal::name, #name, &RejectionCounters::name, text},
    PILOTFISH_TAG_REFUSALS(PILOTFISH_REFUSAL)
#undef PILOTFISH_REFUSAL
};
#undef PILOTFISH_TAG_REFUSALS

inline const std::array<RejectionCounters::Named, RejectionCounters::kCount>& RejectionCounters::all() noexcept {
  static constexpr std::array<Named, kCount> table = {{
#define PILOTFISH_COUNTER(member, name, reason, text) {name, &RejectionCounters::member, #member, Reason::reason, text},
      PILOTFISH_REJECTION_COUNTERS(PILOTFISH_COUNTER)
#undef PILOTFISH_COUNTER
  }};
  return table;
}
#undef PILOTFISH_REJECTION_COUNTERS

/// Counter by counter.
RejectionCounters sum_of(const RejectionCounters& a, const RejectionCounters& b) noexcept;
/// The same.
RejectionCounters larger_of_each(const RejectionCounters& a, const RejectionCounters& b) noexcept;

}  // namespace pilotfish::vision
PILOTFISH_API_END
