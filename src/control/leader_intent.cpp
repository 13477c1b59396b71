#include "pilotfish/control/leader_intent.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/plausible_twist.hpp"
#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {
namespace {

constexpr double kAhead_s = 0.3;    // of the picture: a camera's latency; later is another clock
constexpr double kSigmas = 3.0;     // of the estimate, that a leader intent may be off
constexpr double kDeparting = 2.0;  // tolerances beyond which a leader intent differs from vision

bool drives_away(const LeaderEstimate& seen, const Pose2& own) {
  return seen.mean.segment<2>(2).dot(seen.mean.head<2>() - Eigen::Vector2d(own.x_m, own.y_m)) > 0.0;
}

/// `seen` moved to the announced value, but only towards zero and not beyond.
double no_faster(double seen, double announced) {
  return seen >= 0.0 ? std::clamp(announced, 0.0, seen) : std::clamp(announced, seen, 0.0);
}

/// Uncorrelated with the rest from now on.
void set_sigma(LeaderEstimate& estimate, int of, double sigma) {
  estimate.covariance.row(of).setZero();
  estimate.covariance.col(of).setZero();
  estimate.covariance(of, of) = sigma * sigma;
}

}  // namespace

std::string_view to_string(LeaderIntentUse use) noexcept {
  switch (use) {
    case LeaderIntentUse::silent: return "silent";
    case LeaderIntentUse::probation: return "probation";
    case LeaderIntentUse::agrees: return "agrees";
    case LeaderIntentUse::used: return "used";
    case LeaderIntentUse::suspended: return "suspended";
  }
  return "unknown";
}

bool LeaderIntent::update(std::int64_t utime, const Twist& twist) noexcept {
  if (!is_plausible(twist)) return false;
  if (has_intent() && utime <= newest().utime) return false;
  if (received_.full()) received_.pop_front();
  received_.push_back({twist, utime});
  return true;
}

void LeaderIntent::reset() noexcept {
  bias_mps_.reset();
  agreeing_since_.reset();
  claims_ = {};
}

LeaderIntentUse LeaderIntent::suspend(std::int64_t utime) noexcept {
  reset();
  suspended_until_ = later_s(utime, config_.suspended_s);
  return LeaderIntentUse::suspended;
}

double LeaderIntent::Axis::margin() const { return tolerance + kSigmas * sigma; }

/// Along the leader's own heading: u = (cos psi, sin psi), s = u.v, var(s) = u^T P_v u.
std::array<LeaderIntent::Axis, 2> LeaderIntent::axes(const LeaderEstimate& seen) const noexcept {
  const Eigen::Vector2d u(std::cos(seen.mean(4)), std::sin(seen.mean(4)));
  const Eigen::Matrix2d p = seen.covariance.block<2, 2>(2, 2);
  const double sigma_mps = std::sqrt(std::max(0.0, u.dot(p * u)));
  const double sigma_radps = std::sqrt(std::max(0.0, seen.covariance(5, 5)));
  return {{{&Twist::linear_mps, u.dot(seen.mean.segment<2>(2)), sigma_mps, config_.linear_tolerance_mps},
           {&Twist::angular_radps, seen.mean(5), sigma_radps, config_.angular_tolerance_radps}}};
}

/// Whether the range of the intents in the last confirmed_within_s before utime, and since, contains the measurement:
/// then vision may just be late.
bool LeaderIntent::holds(const Axis& axis, std::int64_t utime) const noexcept {
  double least = newest().twist.*axis.of, most = least;
  for (const Announcement& said : received_) {
    if (seconds_between(said.utime, utime) > config_.confirmed_within_s) continue;
    least = std::min(least, said.twist.*axis.of);
    most = std::max(most, said.twist.*axis.of);
  }
  return axis.seen >= least - axis.margin() && axis.seen <= most + axis.margin();
}

bool LeaderIntent::announces_slower(const Axis& axis) const noexcept {
  const double slow = no_faster(axis.seen, newest().twist.*axis.of);
  return std::abs(axis.seen) - std::abs(slow) > kDeparting * axis.tolerance;
}

LeaderIntentUse LeaderIntent::evaluate(const LeaderEstimate& seen, const Pose2& own, std::int64_t utime) noexcept {
  const double age_s = has_intent() ? seconds_between(newest().utime, utime) : 0.0;
  if (!has_intent() || age_s > config_.max_age_s || age_s < -kAhead_s) {
    reset();
    return LeaderIntentUse::silent;
  }
  if (suspended_until_ && utime < *suspended_until_) return LeaderIntentUse::suspended;
  suspended_until_.reset();

  const std::array<Axis, 2> both = axes(seen);
  if (!holds(both[0], utime) || !holds(both[1], utime)) return suspend(utime);
  if (!agreeing_since_ || seconds_between(*agreeing_since_, utime) < config_.probation_s) {
    // A very uncertain estimate contradicts nothing, so this is no evidence for the leader intent.
    const bool sharp = kSigmas * both[0].sigma <= both[0].tolerance;
    if (!sharp) agreeing_since_.reset();
    if (sharp && !agreeing_since_) agreeing_since_ = utime;
    return LeaderIntentUse::probation;
  }
  if (config_.feed_forward) {
    learn_bias(both[0].seen, utime);
    const bool moving = both[0].seen > both[0].tolerance;
    return moving && drives_away(seen, own) ? LeaderIntentUse::used : LeaderIntentUse::agrees;
  }
  bool slower = false;
  for (std::size_t i = 0; i < both.size(); ++i) {
    std::optional<double>& claim = claims_[i];
    if (announces_slower(both[i])) {
      slower = true;
      if (!claim) claim = std::abs(no_faster(both[i].seen, newest().twist.*both[i].of));
    } else if (claim) {
      if (std::abs(both[i].seen) > *claim + both[i].margin()) return suspend(utime);  // withdrawn too late
      claim.reset();
    }
  }
  return slower && drives_away(seen, own) ? LeaderIntentUse::used : LeaderIntentUse::agrees;
}

/// What is announced for that time: between two announcements in a straight line, after the newest as it says.
double LeaderIntent::announced_mps(std::int64_t utime) const noexcept {
  std::size_t after = received_.size();
  while (after > 0 && received_[after - 1].utime > utime) --after;
  if (after == received_.size()) return newest().twist.linear_mps;
  if (after == 0) return received_[0].twist.linear_mps;
  const Announcement &a = received_[after - 1], &b = received_[after];
  const double share = seconds_between(a.utime, utime) / seconds_between(a.utime, b.utime);
  return a.twist.linear_mps + share * (b.twist.linear_mps - a.twist.linear_mps);
}

/// A leader whose wheels or odometry are a few per cent off announces as much too much, for ever. Low-passed, the
/// difference to vision is that, and what vision lags behind in a change of speed averages out.
void LeaderIntent::learn_bias(double seen_mps, std::int64_t utime) noexcept {
  const double difference_mps = seen_mps - announced_mps(utime);
  if (bias_mps_) {
    const double share = std::clamp(seconds_between(bias_utime_, utime) / config_.bias_time_s, 0.0, 1.0);
    *bias_mps_ += share * (difference_mps - *bias_mps_);
  } else {
    bias_mps_ = difference_mps;
  }
  bias_utime_ = utime;
}

/// With the announced change the speed s along the heading u becomes s + D, D bounded: at most feed_forward_limit_mps
/// more, and no less than standing still. Over the time ahead the change came about evenly: the place moves by D t / 2.
LeaderEstimate LeaderIntent::fed_forward(const LeaderEstimate& predicted, std::int64_t utime,
                                         double ahead_s) const noexcept {
  LeaderEstimate changed = predicted;
  const Axis along = axes(predicted)[0];
  const double wanted_mps = announced_mps(utime) + bias_mps_.value_or(0.0);
  const double change_mps =
      std::clamp(wanted_mps - along.seen, -std::max(along.seen, 0.0), config_.feed_forward_limit_mps);
  const Eigen::Vector2d u(std::cos(predicted.mean(4)), std::sin(predicted.mean(4)));
  changed.mean.segment<2>(2) += change_mps * u;
  changed.mean.head<2>() += 0.5 * ahead_s * change_mps * u;
  // Vision's own doubt in a change of speed, which it sees late, is no doubt in an announcement that has been true so
  // far: a third of the tolerance, as probation asks for. A sharper estimate stays as sharp.
  const double sigma_mps = along.tolerance / kSigmas;
  for (const int of : {2, 3}) {
    const double variance = changed.covariance(of, of);
    if (variance > sigma_mps * sigma_mps) set_sigma(changed, of, sigma_mps);
  }
  return changed;
}

/// The velocity is shortened as a vector, so that a tag that is mounted at an angle is no special case here either. Its
/// old covariance no longer holds; the tolerance takes its place.
LeaderEstimate LeaderIntent::slowed(const LeaderEstimate& seen) const noexcept {
  LeaderEstimate slow = seen;
  const auto [along, turn] = axes(seen);
  if (announces_slower(along)) {
    slow.mean.segment<2>(2) *= no_faster(along.seen, newest().twist.linear_mps) / along.seen;
    set_sigma(slow, 2, along.tolerance);
    set_sigma(slow, 3, along.tolerance);
  }
  if (announces_slower(turn)) {
    slow.mean(5) = no_faster(turn.seen, newest().twist.angular_radps);
    set_sigma(slow, 5, turn.tolerance);
  }
  return slow;
}

}  // namespace pilotfish::control
