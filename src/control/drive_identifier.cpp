#include "pilotfish/control/drive_identifier.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/utime.hpp"
#include "third_difference.hpp"

namespace pilotfish::control {
namespace {

using Identifier = DriveIdentifier;

constexpr double kLongestGap_s = 1.0;             // after which the paths begin anew: the robot stands by then
constexpr double kStored_s = 0.025;               // frames that follow more quickly are not stored
constexpr double kSmallest_m2 = 0.0002 * 0.0002;  // no camera is so exact that less scatter says more
constexpr double kMedianOfTwo = 1.3862944;        // of chi-square with two degrees of freedom
constexpr double kBounded = 9.0;                  // rho(x) = x / (1 + x / kBounded)
constexpr double kSharpest = 50.0;                // evidence between neighbours beyond which old evidence fades,
constexpr double kFading_s = 5.0;                 // with this time constant: a drive can change
constexpr double kRefined = 0.5;                  // places of the grid, without a new proof
constexpr double kRhythm_s = 4.0;                 // time constant with which a rhythm of the leader is forgotten

double latency_at(double index) { return Identifier::kFirstLatency_s + Identifier::kLatencyStep_s * index; }
double lag_at(double index) { return Identifier::kLagScale_s * std::expm1(Identifier::kLagRatio * index); }
double index_of_latency(double latency_s) {
  return (latency_s - Identifier::kFirstLatency_s) / Identifier::kLatencyStep_s;
}
double index_of_lag(double lag_s) { return std::log1p(lag_s / Identifier::kLagScale_s) / Identifier::kLagRatio; }

}  // namespace

DriveIdentifier::DriveIdentifier(const DriveModelConfig& configured, const LimitsConfig& limits)
    : configured_(configured), limits_(limits) {
  for (std::size_t i = 0; i < kLatencies; ++i)
    for (std::size_t j = 0; j < kLags; ++j) {
      const double latency = (latency_at(static_cast<double>(i)) - configured.latency_s) / kPriorLatencySigma_s;
      const double lag =
          (static_cast<double>(j) - index_of_lag(configured.actuator_lag_s)) * kLagRatio / kPriorLagSigma;
      log_probability(i, j) = -0.5 * (latency * latency + lag * lag);
    }
  estimate_.latency_s = reference_latency_s_ = configured.latency_s;
  estimate_.actuator_lag_s = reference_lag_s_ = configured.actuator_lag_s;
  forget_sigmas();
}

void DriveIdentifier::forget_sigmas() noexcept {
  estimate_.latency_sigma_s = kPriorLatencySigma_s;
  estimate_.actuator_lag_sigma_s = kPriorLagSigma * (estimate_.actuator_lag_s + kLagScale_s);
}

void DriveIdentifier::restart_on_new_clock() noexcept {
  started_ = false;
  nodes_made_ = 0;
  pending_.clear();
  seen_.clear();
}

void DriveIdentifier::command(const Twist& twist, std::int64_t utime) noexcept {
  if (!is_finite(twist)) return;
  if (pending_.full()) {
    acting_ = pending_.front().twist;
    pending_.pop_front();
  }
  pending_.push_back({twist, utime});
}

void DriveIdentifier::observe(std::int64_t utime, double distance_m, double bearing_rad) noexcept {
  if (!std::isfinite(distance_m) || !std::isfinite(bearing_rad) || (started_ && utime <= present_utime_)) return;
  const double since_last_s = started_ ? seconds_between(present_utime_, utime) : kLongestGap_s;
  advance_to(utime);
  if (!seen_.empty() && seconds_between(seen_.back().utime, utime) < kStored_s) return;
  if (seen_.full()) seen_.pop_front();
  seen_.push_back({utime, distance_m * std::cos(bearing_rad), distance_m * std::sin(bearing_rad)});
  Pictures pictures;
  if (since_last_s >= kLongestGap_s || !pick(pictures)) return;
  weigh(pictures, std::min(since_last_s, kSpacing_s));
  update_estimate();
}

void DriveIdentifier::advance_to(std::int64_t utime) noexcept {
  if (!started_ || seconds_between(present_utime_, utime) >= kLongestGap_s) {
    // The robot stands: after so long without a picture the command has been zero for a while.
    started_ = true;
    present_.fill(Wheels{});
    set_value_ = acting_ = Twist{};
    pending_.clear();
    seen_.clear();
    nodes_made_ = 0;
    present_utime_ = node_utime_ = utime;
    store_node();
    return;
  }
  constexpr auto kNode_us = static_cast<std::int64_t>(kNode_s * 1e6);
  while (present_utime_ < utime) {
    while (!pending_.empty() && pending_.front().utime <= present_utime_) {
      acting_ = pending_.front().twist;
      pending_.pop_front();
    }
    std::int64_t next = std::min(utime, node_utime_ + kNode_us);
    if (!pending_.empty()) next = std::min(next, pending_.front().utime);
    drive_for(seconds_between(present_utime_, next));
    present_utime_ = next;
    if (present_utime_ < node_utime_ + kNode_us) continue;
    node_utime_ += kNode_us;
    store_node();
  }
}

/// The set value ramps alike for all; each lag follows it for itself.
void DriveIdentifier::drive_for(double duration_s) noexcept {
  const Twist before = set_value_;
  for (std::size_t j = 0; j < kLags; ++j) {
    const double lag_s = lag_at(static_cast<double>(j));
    Wheels& wheels = present_[j];
    set_value_ = before;
    const Twist mean{follow_set_value(wheels.twist.linear_mps, set_value_.linear_mps, acting_.linear_mps,
                                      limits_.max_linear_acceleration_mps2, lag_s, duration_s) /
                         duration_s,
                     follow_set_value(wheels.twist.angular_radps, set_value_.angular_radps, acting_.angular_radps,
                                      limits_.max_angular_acceleration_radps2, lag_s, duration_s) /
                         duration_s};
    wheels.pose = move_along_arc(wheels.pose, mean, duration_s);
  }
}

void DriveIdentifier::store_node() noexcept {
  Row& row = nodes_[nodes_made_ % kNodes];
  for (std::size_t j = 0; j < kLags; ++j) {
    const Pose2& pose = present_[j].pose;
    row[j] = {pose.x_m, pose.y_m, std::cos(pose.heading_rad), std::sin(pose.heading_rad)};
  }
  ++nodes_made_;
}

/// The latest picture and those nearest to one, two and more spacings before it; false unless there are any, and the
/// paths reach back to them.
bool DriveIdentifier::pick(Pictures& pictures) const noexcept {
  const Seen& latest = seen_.back();
  pictures.back() = latest;
  for (std::size_t back = 1; back < kPictures; ++back) {
    const double wanted_s = static_cast<double>(back) * kSpacing_s;
    const Seen* nearest = seen_.begin();
    for (const Seen& each : seen_)
      if (std::abs(seconds_between(each.utime, latest.utime) - wanted_s) <
          std::abs(seconds_between(nearest->utime, latest.utime) - wanted_s))
        nearest = &each;
    if (std::abs(seconds_between(nearest->utime, latest.utime) - wanted_s) > 0.4 * kSpacing_s) return false;
    pictures[kPictures - 1 - back] = *nearest;
  }
  const double stored_s = kNode_s * (static_cast<double>(std::min<std::uint64_t>(nodes_made_, kNodes)) - 1.0);
  const double longest_s = latency_at(static_cast<double>(kLatencies - 1));
  return seconds_between(pictures.front().utime, node_utime_) + longest_s < stored_s - kNode_s;
}

void DriveIdentifier::weigh(const Pictures& pictures, double since_last_s) noexcept {
  std::array<ThirdDifference, 3> difference;  // r, r' and r'': of the last four, of those one earlier, two earlier
  for (std::size_t n = 0; n < 3; ++n) {
    std::array<Seen, 4> four;
    std::copy_n(pictures.begin() + static_cast<std::ptrdiff_t>(2 - n), 4, four.begin());
    difference[n] = third_difference(four);
    for (double& each : difference[n].weight) each /= std::sqrt(difference[n].norm2);
  }
  const double counts = since_last_s / (1.5 * kSpacing_s), keep = std::exp(-since_last_s / kRhythm_s);
  std::array<double, kLatencies * kLags> squared;
  for (std::size_t latency = 0; latency < kLatencies; ++latency) {
    std::array<std::array<LeaderRhythm::Planar, 3>, kLags> r{};
    for (std::size_t i = 0; i < kPictures; ++i) {
      // How many nodes before the last one the robot was, for this latency, where the picture was taken.
      const double back =
          (seconds_between(pictures[i].utime, node_utime_) + latency_at(static_cast<double>(latency))) / kNode_s;
      const auto whole = static_cast<std::uint64_t>(back);
      const double part = back - static_cast<double>(whole);
      const Row& after = nodes_[(nodes_made_ - 1 - whole) % kNodes];
      const Row& before = nodes_[(nodes_made_ - 2 - whole) % kNodes];
      const double a = 1.0 - part, b = part;
      const double forward = pictures[i].forward_m, left = pictures[i].left_m;
      for (std::size_t j = 0; j < kLags; ++j) {
        const Place &p = after[j], &q = before[j];
        const double x =
            a * (p.x_m + p.cosine * forward - p.sine * left) + b * (q.x_m + q.cosine * forward - q.sine * left);
        const double y =
            a * (p.y_m + p.sine * forward + p.cosine * left) + b * (q.y_m + q.sine * forward + q.cosine * left);
        for (std::size_t n = 0; n < 3; ++n) {
          if (i + n < 2 || i + n > 5) continue;  // r^(n) is made of pictures 2 - n to 5 - n
          r[j][n].x_m += difference[n].weight[i + n - 2] * x;
          r[j][n].y_m += difference[n].weight[i + n - 2] * y;
        }
      }
    }
    for (std::size_t j = 0; j < kLags; ++j) {
      const std::size_t k = latency * kLags + j;
      squared[k] = rhythms_[k].unexplained_m2(r[j], counts, keep);
    }
  }

  auto* best = std::max_element(log_probability_.begin(), log_probability_.end());
  if (squares_.full()) squares_.pop_front();
  squares_.push_back(squared[static_cast<std::size_t>(best - log_probability_.begin())]);
  std::array<double, kSquares> sorted{};
  std::copy(squares_.begin(), squares_.end(), sorted.begin());
  auto* middle = sorted.begin() + squares_.size() / 2;
  std::nth_element(sorted.begin(), middle, sorted.begin() + squares_.size());
  const double variance_m2 = std::max(*middle / kMedianOfTwo, kSmallest_m2);
  const double remains = std::exp(-since_last_s / kFading_s);
  for (std::size_t k = 0; k < squared.size(); ++k) {
    const double x = squared[k] / variance_m2;
    const double cost = 0.5 * counts * x / (1.0 + x / kBounded);
    log_probability_[k] -= cost;
    cost_[k] = remains * cost_[k] + cost;
  }
  best = std::max_element(log_probability_.begin(), log_probability_.end());
  const double most = *best;
  for (double& each : log_probability_) each -= most;
  const auto index = static_cast<std::size_t>(best - log_probability_.begin());
  const std::size_t below = index >= kLags ? index - kLags : index + kLags;
  const std::size_t above = index + kLags < squared.size() ? index + kLags : index - kLags;
  if (std::max(log_probability_[below], log_probability_[above]) < -kSharpest)
    for (double& each : log_probability_) each *= remains;
}

/// With p the logarithm of the probability around the best node, p(i, j) = p0 + g.(i, j) + (i, j) H (i, j) / 2: the
/// vertex is -H^-1 g away and the covariance -H^-1, in units of the grid.
void DriveIdentifier::update_estimate() noexcept {
  const auto* best = std::max_element(log_probability_.begin(), log_probability_.end());
  const auto index = static_cast<std::size_t>(best - log_probability_.begin());
  const std::size_t i = std::clamp<std::size_t>(index / kLags, 1, kLatencies - 2);
  const std::size_t j = std::clamp<std::size_t>(index % kLags, 1, kLags - 2);
  const auto p = [&](int di, int dj) { return log_probability(i + di, j + dj); };
  const double gi = (p(1, 0) - p(-1, 0)) / 2.0, gj = (p(0, 1) - p(0, -1)) / 2.0;
  const double hii = p(1, 0) - 2.0 * p(0, 0) + p(-1, 0), hjj = p(0, 1) - 2.0 * p(0, 0) + p(0, -1);
  const double hij = (p(1, 1) - p(1, -1) - p(-1, 1) + p(-1, -1)) / 4.0;
  const double determinant = hii * hjj - hij * hij;
  forget_sigmas();
  if (!(hii < 0.0) || !(determinant > 1e-9)) return;
  const double di = std::clamp((-hjj * gi + hij * gj) / determinant, -1.0, 1.0);
  const double dj = std::clamp((hij * gi - hii * gj) / determinant, -1.0, 1.0);
  const double latency_s = latency_at(static_cast<double>(i) + di), lag_s = lag_at(static_cast<double>(j) + dj);
  const double relative_lag_sigma = std::min(kLagRatio * std::sqrt(-hii / determinant), kPriorLagSigma);
  estimate_.latency_sigma_s = std::min(kLatencyStep_s * std::sqrt(-hjj / determinant), kPriorLatencySigma_s);
  estimate_.actuator_lag_sigma_s = (lag_s + kLagScale_s) * relative_lag_sigma;

  // What is in use is as probable as the most probable place around it, and costs as much as the cheapest.
  const auto near = [](double at, std::size_t count) {
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(count - 2)));
  };
  const std::size_t first =
      near(index_of_latency(reference_latency_s_), kLatencies) * kLags + near(index_of_lag(reference_lag_s_), kLags);
  const std::array<std::size_t, 4> around{first, first + 1, first + kLags, first + kLags + 1};
  double in_use = log_probability_[first], in_use_cost = cost_[first];
  for (const std::size_t k : around) {
    in_use = std::max(in_use, log_probability_[k]);
    in_use_cost = std::min(in_use_cost, cost_[k]);
  }
  const bool sure = estimate_.latency_sigma_s < kSure_latency_s && relative_lag_sigma < kSure_lag;
  if (sure && in_use < -kStrong && in_use_cost > kTimes * cost_[index]) {
    estimate_.differs_from_settings = true;
    reference_latency_s_ = latency_s;
    reference_lag_s_ = lag_s;
  }
  if (!sure || !estimate_.differs_from_settings) return;
  const double at_latency = index_of_latency(reference_latency_s_), at_lag = index_of_lag(reference_lag_s_);
  estimate_.latency_s = std::clamp(latency_s, latency_at(at_latency - kRefined), latency_at(at_latency + kRefined));
  estimate_.actuator_lag_s = std::clamp(lag_s, lag_at(at_lag - kRefined), lag_at(at_lag + kRefined));
}

}  // namespace pilotfish::control
