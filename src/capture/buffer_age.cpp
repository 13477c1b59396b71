#include "buffer_age.hpp"

#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::capture {
namespace {

/// What lies between two looks at the clocks that follow each other; no computer sleeps for less.
constexpr std::int64_t kShortestSleepUs = 10'000;

}  // namespace

ClockReading read_clocks() noexcept {
  // Boottime first: if this thread is delayed in between, boottime - monotonic comes out too small, and the largest
  // value so far is used. The wall clock last, beside the monotonic one.
  const std::int64_t boottime_us = monotonic_now().us;
  const std::int64_t monotonic_us = unsuspended_now_us();
  return {monotonic_us, boottime_us, wall_utime()};
}

Suspension look_for_suspension(const Suspension& suspension, const ClockReading& now) noexcept {
  const std::int64_t offset_us = now.boottime_us - now.monotonic_us;
  const std::int64_t more_us = offset_us - suspension.offset_us;
  Suspension after = suspension;
  if (more_us > 0) after.offset_us = offset_us;
  if (more_us >= kShortestSleepUs) {
    after.noticed_at_us = now.monotonic_us;
    after.slept_us = more_us;
  }
  return after;
}

std::int64_t buffer_age_us(const v4l2_buffer& buffer, std::int64_t queue_seen_empty_at_us, const ClockReading& now,
                           const Suspension& suspension) noexcept {
  if (!has_monotonic_stamp(buffer)) return now.boottime_us - queue_seen_empty_at_us;
  const std::int64_t stamp_us = std::int64_t{buffer.timestamp.tv_sec} * 1'000'000 + buffer.timestamp.tv_usec;
  const std::int64_t age_us = now.monotonic_us - stamp_us;
  return stamp_us < suspension.noticed_at_us ? age_us + suspension.slept_us : age_us;
}

bool has_monotonic_stamp(const v4l2_buffer& buffer) noexcept {
  // Reject values that are no time at all; 2^40 s are 35 000 years.
  constexpr std::int64_t kFarSeconds = std::int64_t{1} << 40;
  const std::int64_t stamp_s = buffer.timestamp.tv_sec, stamp_us = buffer.timestamp.tv_usec;
  return (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC && stamp_s > -kFarSeconds &&
         stamp_s < kFarSeconds && stamp_us > -1'000'000 && stamp_us < 1'000'000;
}

}  // namespace pilotfish::capture
