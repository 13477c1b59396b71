#include "pilotfish/control/leader_search.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {
namespace {

constexpr double kThere_rad = radians(2.0);
constexpr double kSoft_per_s = 4.0;  // turn rate over what is left to turn: an end is approached, not overshot
constexpr std::int64_t kTurnsATry = 3;

}  // namespace

void LeaderSearch::seen(std::int64_t utime, double direction_rad) noexcept {
  seen_utime_ = utime;
  direction_rad_ = direction_rad;
  side_ = 0.0;
  turns_ = 0;
}

double LeaderSearch::turn_rate(std::int64_t utime, double heading_rad) noexcept {
  if (!config_.search_by_rotating || !seen_utime_) return 0.0;
  if (seconds_between(*seen_utime_, utime) < config_.after_s) return 0.0;
  if (turns_ >= kTurnsATry * (1 + config_.max_retries)) return 0.0;
  if (side_ == 0.0) side_ = direction_rad_ >= heading_rad ? 1.0 : -1.0;
  const std::int64_t phase = turns_ % kTurnsATry;
  const double beyond_rad = phase == 0 ? config_.sweep_rad : phase == 1 ? -config_.sweep_rad : 0.0;
  const double left_rad = direction_rad_ + side_ * beyond_rad - heading_rad;
  if (std::abs(left_rad) < kThere_rad) {
    ++turns_;
    return 0.0;
  }
  return std::clamp(kSoft_per_s * left_rad, -config_.turn_rate_radps, config_.turn_rate_radps);
}

void LeaderSearch::restart() noexcept {
  seen_utime_.reset();
  side_ = 0.0;
  turns_ = 0;
}

}  // namespace pilotfish::control
