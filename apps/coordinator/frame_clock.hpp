#pragma once

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "frame_feed.hpp"

namespace pilotfish::apps {

/// Relates the frames' own clock to this program's monotonic one, so that ages never depend on a clock that may jump.
///
/// Two questions: how late is it now on the frames' clock, and was this frame already old when it arrived? The second
/// can be answered only if frames are stamped by this host's wall clock (a camera here). A simulator or a replayed log
/// has a time of its own, which may run faster or slower than ours, and there only the arrival counts.
class FrameClock {
 public:
  /// wall_utime and now are read at the same instant.
  FrameClock(std::int64_t wall_utime, MonotonicClock::time_point now) : wall_utime_(wall_utime), started_(now) {}

  /// What the wall clock says now. True if it has been set since: a computer without a battery-backed clock starts with
  /// the wrong time and jumps once it has a network. Stamps are then compared with the new time.
  bool wall_clock_jumped(std::int64_t wall_utime, MonotonicClock::time_point now) {
    if (std::abs(wall_utime - (wall_utime_ + microseconds(now - started_))) < kJump_us) return false;
    wall_utime_ = wall_utime;
    started_ = now;
    return true;
  }

  void arrived(const Arrival& arrival) {
    if (!last_utime_) same_clock_ = std::abs(age_us(arrival)) < kSameClock_us;
    last_utime_ = arrival.frame.utime;
    last_arrival_ = arrival.at;
  }

  /// The frames' time at `now`; 0 before any frame. On our own clock it is simply now, so that an old picture cannot
  /// make the last measurement look young; else the last frame's exposure plus what has passed here since it arrived.
  std::int64_t utime_at(MonotonicClock::time_point now) const {
    if (same_clock_) return wall_utime_ + microseconds(now - started_);
    return last_utime_ ? *last_utime_ + microseconds(now - last_arrival_) : 0;
  }

  /// Call after arrived(). Frames from the future are as wrong as old ones.
  bool is_stale(const Arrival& arrival, double max_age_s) const {
    return same_clock_ && std::abs(age_us(arrival)) > static_cast<std::int64_t>(max_age_s * 1e6);
  }

  /// What has passed since the frame's exposure; nothing if its stamp is of another clock. Call after arrived().
  std::optional<double> since_exposure_s(const Arrival& arrival, MonotonicClock::time_point now) const {
    if (!same_clock_) return std::nullopt;
    return static_cast<double>(age_us(arrival) + microseconds(now - arrival.at)) * 1e-6;
  }

  const std::optional<std::int64_t>& last_utime() const { return last_utime_; }

 private:
  /// Stamps closer than this to our wall clock are taken for stamps of our wall clock; decided on the first frame.
  static constexpr std::int64_t kSameClock_us = 10'000'000;
  /// More than scheduling can cause between two readings; slewing moves both clocks alike.
  static constexpr std::int64_t kJump_us = 50'000;

  static std::int64_t microseconds(MonotonicClock::duration duration) {
    return std::chrono::duration_cast<std::chrono::microseconds>(duration).count();
  }
  std::int64_t age_us(const Arrival& arrival) const {
    return wall_utime_ + microseconds(arrival.at - started_) - arrival.frame.utime;
  }

  std::int64_t wall_utime_;
  MonotonicClock::time_point started_;
  bool same_clock_ = false;
  std::optional<std::int64_t> last_utime_;
  MonotonicClock::time_point last_arrival_;
};

}  // namespace pilotfish::apps
