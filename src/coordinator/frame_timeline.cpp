#include "pilotfish/coordinator/frame_timeline.hpp"

#include <algorithm>
#include <cmath>

namespace pilotfish {
namespace {

/// As doubles: two stamps off a wire may be farther apart than an int64 can say.
double between_us(std::int64_t from, std::int64_t to) { return static_cast<double>(to) - static_cast<double>(from); }

}  // namespace

std::optional<std::int64_t> FrameTimeline::last_utime() const {
  return last_ ? std::optional(last_->utime) : std::nullopt;
}

bool FrameTimeline::agrees_with_run(std::int64_t utime, MonotonicTime now) const noexcept {
  if (!run_) return false;
  const double stamps_us = between_us(run_->utime, utime), passed_us = between_us(run_->at.us, now.us);
  return stamps_us > 0.0 && stamps_us <= kRunGap_us && std::abs(stamps_us - passed_us) <= kAgree_us;
}

bool FrameTimeline::continues_numbering(std::int64_t utime, MonotonicTime now) const noexcept {
  const std::size_t known = std::min<std::size_t>(numbered_, kNumbering);
  return std::any_of(numbering_.begin(), numbering_.begin() + known, [&](const Mark& mark) {
    return std::abs(between_us(mark.utime, utime) - between_us(mark.at.us, now.us)) <= kAgree_us;
  });
}

void FrameTimeline::remember_numbering(std::int64_t utime, MonotonicTime now) noexcept {
  numbering_[numbered_++ % kNumbering] = Mark{utime, now};
}

bool FrameTimeline::is_proven(std::int64_t known_age_us, MonotonicTime now) noexcept {
  if (confirmed_ || known_age_us == 0 || known_age_us > max_age_us_ || static_cast<double>(known_age_us) < -kAhead_us)
    return false;
  if (!confirming_since_ || between_us(confirming_since_->us, now.us) > kQuickWithin_us) {
    confirming_since_ = now;
    confirmations_ = 0;
  }
  return ++confirmations_ >= kConfirmations;
}

StampVerdict FrameTimeline::begin_epoch(std::int64_t utime, std::int64_t known_age_us, MonotonicTime now) noexcept {
  // The first frame of an epoch is the reference for all that follow, so here an age counts however large it is: a
  // recording of an hour ago has stamps that are an hour old.
  if (static_cast<double>(known_age_us) < -kAhead_us) return {Reason::frame_time_implausible, false, 0};
  if (known_age_us > max_age_us_) return {Reason::frame_stale, false, 0};
  const bool first = !last_;
  if (!first) ++epochs_;
  last_ = Mark{utime, now};
  numbered_ = 0;
  remember_numbering(utime, now);
  offset_us_ = least_us_ = 0.0;
  run_.reset();
  agreeing_ = quick_ = confirmations_ = 0;
  confirming_since_.reset();
  confirmed_ = known_age_us != 0;
  return {Reason::none, !first, std::max<std::int64_t>(known_age_us, 0)};
}

StampVerdict FrameTimeline::refuse(Reason reason, std::int64_t utime, MonotonicTime now) noexcept {
  if (continues_numbering(utime, now)) {
    remember_numbering(utime, now);
    run_.reset();
    agreeing_ = 0;
  } else {
    agreeing_ = agrees_with_run(utime, now) ? agreeing_ + 1 : 1;
    run_ = Mark{utime, now};
  }
  return {reason, false, 0};
}

bool FrameTimeline::is_confirmed_quick(double offset_us, MonotonicTime now) noexcept {
  if (offset_us < -kQuickWithin_us) return false;  // nothing takes that long and is accepted afterwards
  if (!quick_since_ || between_us(quick_since_->us, now.us) > kQuickWithin_us) {
    quick_since_ = now;
    quick_ = 0;
  }
  ++quick_;
  // Stamps that run faster than time would cause this repeatedly.
  if (quick_ < kQuickFrames || (quick_epoch_at_ && between_us(quick_epoch_at_->us, now.us) < kQuickAgainAfter_us))
    return false;
  quick_epoch_at_ = now;
  return true;
}

StampVerdict FrameTimeline::classify(std::int64_t utime, std::int64_t known_age_us, MonotonicTime now) noexcept {
  // In the future by a clock that both sides share: this is certain, so it is no evidence for a new epoch either.
  const auto known_us = static_cast<double>(known_age_us);
  const bool shared = std::abs(known_us) < kSharedClock_us;
  if (shared && known_us < -kAhead_us) return {Reason::frame_time_implausible, false, 0};
  if (!last_) return begin_epoch(utime, known_age_us, now);

  // The run goes on, whether or not its stamps have caught up with the old epoch's by now.
  const double passed_us = std::max(between_us(last_->at.us, now.us), 0.0);
  const bool run_complete = may_begin(known_age_us) && agreeing_ >= kFramesToAgree - 1 && passed_us >= kSilence_us &&
                            agrees_with_run(utime, now) && !continues_numbering(utime, now);
  const double stamps_us = between_us(last_->utime, utime);
  if (stamps_us == 0.0) return {Reason::frame_time_not_advancing, false, 0};  // the same picture, sent again
  if (stamps_us < 0.0)
    return run_complete || is_proven(known_age_us, now) ? begin_epoch(utime, known_age_us, now)
                                                        : refuse(Reason::frame_time_not_advancing, utime, now);

  const double drift_us = kDrift * passed_us;
  const double pull_us = std::clamp(offset_us_, -drift_us, drift_us);
  const double offset_us = offset_us_ - pull_us + passed_us - stamps_us;
  if (offset_us < -kAhead_us)
    return run_complete || is_proven(known_age_us, now) ||
                   (may_begin(known_age_us) && is_confirmed_quick(offset_us, now))
               ? begin_epoch(utime, known_age_us, now)
               : refuse(Reason::frame_time_implausible, utime, now);

  const double least_us = std::min(least_us_ - pull_us + drift_us, offset_us);
  const double late_us = std::max(offset_us - least_us, shared ? known_us : 0.0);
  const bool stale = late_us > static_cast<double>(max_age_us_);
  const bool continues = continues_numbering(utime, now);
  if (stale && !continues && agrees_with_run(utime, now))
    // The clock was set back by a little, and its stamps are past the last one.
    return run_complete ? begin_epoch(utime, known_age_us, now) : refuse(Reason::frame_stale, utime, now);

  last_ = Mark{utime, now};
  remember_numbering(utime, now);
  offset_us_ = offset_us;
  least_us_ = least_us;
  if (!stale || continues) {
    run_.reset();
    agreeing_ = 0;
  }
  if (stale) return {Reason::frame_stale, false, 0};
  return {Reason::none, false, static_cast<std::int64_t>(std::max(late_us, 0.0))};
}

}  // namespace pilotfish
