#pragma once

#include <linux/videodev2.h>

#include <cstdint>

namespace pilotfish::capture {

/// This host's clocks at one instant [us].
struct ClockReading {
  std::int64_t monotonic_us = 0;  ///< CLOCK_MONOTONIC: what V4L2 stamps buffers with; stands still while suspended
  std::int64_t boottime_us = 0;   ///< CLOCK_BOOTTIME: what ages are counted on; does not
  std::int64_t wall_us = 0;
};

ClockReading read_clocks() noexcept;

/// When the computer was last suspended, detected by a change of the difference of the two clocks.
struct Suspension {
  std::int64_t offset_us = 0;      ///< boottime - monotonic, the most that was seen
  std::int64_t noticed_at_us = 0;  ///< monotonic
  std::int64_t slept_us = 0;
};

/// `suspension` after one more look at the clocks.
Suspension look_for_suspension(const Suspension& suspension, const ClockReading& now) noexcept;

/// How long ago the picture in a buffer was taken, as far as is known [us]; negative if its stamp is in the future.
///
/// With a monotonic stamp: monotonic now - stamp, and the sleep on top if the stamp is older than the notice of it,
/// because the picture may have been taken before. Without one (or with one that was copied from elsewhere): the
/// buffer was filled after the queue was last seen empty, so it is at most that old. That is the safe bound.
std::int64_t buffer_age_us(const v4l2_buffer& buffer, std::int64_t queue_seen_empty_at_us, const ClockReading& now,
                           const Suspension& suspension) noexcept;

/// The driver's flags say that it stamped the buffer with CLOCK_MONOTONIC, and the stamp is one.
bool has_monotonic_stamp(const v4l2_buffer& buffer) noexcept;

}  // namespace pilotfish::capture
