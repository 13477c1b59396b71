#include "pilotfish/coordinator/leader_choice.hpp"

#include <sstream>

#include "pilotfish/core/utime.hpp"

namespace pilotfish {

LeaderChoice::LeaderChoice(const LeaderChoiceConfig& config, std::size_t leaders, double max_gap_s)
    : after_lost_s_(config.after_lost_s), back_after_s_(config.back_after_s), max_gap_s_(max_gap_s), leaders_(leaders) {
  check_ranges(config, "alternatives");
  if (leaders > kMaxLeaders)
    throw ConfigError("alternatives.leaders",
                      std::to_string(leaders - 1) + " leaders; at most " + std::to_string(kMaxLeaders - 1));
  if (back_after_s_ == 0.0 || back_after_s_ >= after_lost_s_) return;
  std::ostringstream problem;
  problem << back_after_s_ << " is shorter than alternatives.after_lost_s (" << after_lost_s_
          << "), so that a leader that comes and goes would be changed again and again; allowed: 0 (never), or "
          << after_lost_s_ << " to 3600";
  throw ConfigError("alternatives.back_after_s", problem.str());
}

bool LeaderChoice::update(std::int64_t utime, const LeadersSeen& seen) noexcept {
  for (std::size_t i = 0; i < leaders_; ++i) {
    Streak& streak = streaks_[i];
    const bool gap = streak.frames > 0 && seconds_between(streak.last_utime, utime) > max_gap_s_;
    if (gap) streak = {};
    if (!seen[i]) continue;
    if (streak.frames == 0) streak.since_utime = utime;
    streak.last_utime = utime;
    ++streak.frames;
  }
  utime_ = utime;
  if (seen[followed_] || !seen_utime_) seen_utime_ = utime;
  lost_ = seconds_between(*seen_utime_, utime) >= after_lost_s_;
  if (lost_) {
    for (std::size_t i = 0; i < leaders_; ++i)
      if (i != followed_ && is_reliable(i)) return change_to(i);
  } else if (followed_ != 0 && back_after_s_ > 0.0 && is_reliable(0) &&
             seconds_between(streaks_[0].since_utime, utime) >= back_after_s_) {
    return change_to(0);
  }
  return false;
}

bool LeaderChoice::is_reliable(std::size_t leader) const noexcept {
  return streaks_[leader].frames >= kFrames && streaks_[leader].last_utime == *utime_;
}

bool LeaderChoice::change_to(std::size_t leader) noexcept {
  followed_ = leader;
  ++changes_;
  seen_utime_ = utime_;
  lost_ = false;
  streaks_ = {};
  return true;
}

double LeaderChoice::unseen_s() const { return seen_utime_ ? seconds_between(*seen_utime_, *utime_) : 0.0; }

void LeaderChoice::restart() noexcept {
  utime_.reset();
  seen_utime_.reset();
  lost_ = false;
  streaks_ = {};
}

}  // namespace pilotfish
