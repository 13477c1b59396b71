#pragma once

#include <array>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/vision/tag_measurement.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// Everything that was turned away since the start, by reason.
struct RejectionCounters {
  std::int64_t frames_invalid = 0;  ///< frames that cannot be read or are not of the calibration's size
  std::int64_t hamming = 0;         ///< tags that read as something else
  std::int64_t margin = 0;          ///< tags with too little contrast
  std::int64_t residual = 0;        ///< tags of which something else explains too much
  std::int64_t foreign_id = 0;      ///< tags of the family that the leader does not wear
  std::int64_t duplicate_id = 0;    ///< an id seen twice in one picture: none of the two is accepted
  std::int64_t outside_frame = 0;   ///< tags partly outside the picture
  std::int64_t too_small = 0;       ///< tags too small to be read
  std::int64_t too_blurred = 0;     ///< tags too blurred to be accepted
  std::int64_t size = 0;            ///< tags with a size that they cannot have at any range
  std::int64_t behind = 0;          ///< poses behind the camera, or that show a tag's back
  std::int64_t jump = 0;            ///< leaders farther from where they were than anything can have moved
  std::int64_t pose = 0;            ///< corners that no credible pose explains

  /// A counter and its name.
  struct Named {
    const char* name;                        ///< on the wire
    std::int64_t RejectionCounters::*count;  ///< which one
  };
  /// All of them, by name.
  static const std::array<Named, 13>& all() noexcept;

  /// One tag more that was refused. Returns what a status calls that, or `otherwise` for a tag that was not found:
  /// something stands before it, or it was never there, which is no refusal.
  Reason count(TagRefusal refusal, Reason otherwise) noexcept;
  /// One pose more that was refused.
  void count_pose(Reason refusal) noexcept;
};

/// Counter by counter.
RejectionCounters sum_of(const RejectionCounters& a, const RejectionCounters& b) noexcept;
/// The same.
RejectionCounters larger_of_each(const RejectionCounters& a, const RejectionCounters& b) noexcept;

}  // namespace pilotfish::vision
PILOTFISH_API_END
