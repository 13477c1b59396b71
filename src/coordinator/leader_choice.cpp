#include "pilotfish/coordinator/leader_choice.hpp"

#include <cmath>
#include <sstream>

namespace pilotfish {
namespace {

/// Of whole microseconds, which seconds as doubles are not: a time of ten periods is reached in the tenth frame.
double passed_us(std::int64_t from, std::int64_t to) { return static_cast<double>(to) - static_cast<double>(from); }

}  // namespace

LeaderChoice::LeaderChoice(const LeaderChoiceConfig& config, std::size_t leaders, double max_gap_s)
    : after_lost_us_(std::round(config.after_lost_s * 1e6)),
      back_after_us_(std::round(config.back_after_s * 1e6)),
      max_gap_us_(std::round(max_gap_s * 1e6)),
      leaders_(leaders) {
  check_ranges(config, "alternatives");
  if (leaders > kMaxLeaders)
    throw ConfigError("alternatives.leaders",
                      std::to_string(leaders - 1) + " leaders; at most " + std::to_string(kMaxLeaders - 1));
  if (config.back_after_s == 0.0 || config.back_after_s >= config.after_lost_s) return;
  std::ostringstream problem;
  problem << config.back_after_s << " is shorter than alternatives.after_lost_s (" << config.after_lost_s
          << "), so that a leader that comes and goes would be changed again and again; allowed: 0 (never), or "
          << config.after_lost_s << " to 3600";
  throw ConfigError("alternatives.back_after_s", problem.str());
}

bool LeaderChoice::update(std::int64_t utime, const LeadersSeen& seen) noexcept {
  for (std::size_t i = 0; i < leaders_; ++i) {
    Streak& streak = streaks_[i];
    const bool gap = streak.frames > 0 && passed_us(streak.last_utime, utime) > max_gap_us_;
    if (gap) streak = {};
    if (!seen[i]) continue;
    if (streak.frames == 0) streak.since_utime = utime;
    streak.last_utime = utime;
    ++streak.frames;
  }
  utime_ = utime;
  if (seen[followed_] || !seen_utime_) seen_utime_ = utime;
  lost_ = passed_us(*seen_utime_, utime) >= after_lost_us_;
  if (lost_) {
    for (std::size_t i = 0; i < leaders_; ++i)
      if (i != followed_ && is_reliable(i)) return change_to(i);
  } else if (followed_ != 0 && back_after_us_ > 0.0 && is_reliable(0) &&
             passed_us(streaks_[0].since_utime, utime) >= back_after_us_) {
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

void LeaderChoice::restart() noexcept {
  utime_.reset();
  seen_utime_.reset();
  lost_ = false;
  streaks_ = {};
}

}  // namespace pilotfish
