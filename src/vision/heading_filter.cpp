#include "pilotfish/vision/heading_filter.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::vision {
namespace {

constexpr double kUnknownRate_radps = 0.5;    ///< standard deviation of a new hypothesis' rate
constexpr double kNewcomerLogWeight = -14.0;  ///< a hypothesis without a predecessor starts with about a millionth
constexpr double kDroppedLogWeight = -20.0;   ///< below the best
/// A systematic error (calibration, template) favours the same wrong solution in every frame, which noise does not.
/// So evidence is weighted by half.
constexpr double kEvidenceWeight = 0.5;

}  // namespace

void HeadingFilter::predict(double dt_s) noexcept {
  Eigen::Matrix2d F;
  F << 1.0, dt_s, 0.0, 1.0;
  const Eigen::Vector2d push(0.5 * dt_s * dt_s, dt_s);  // of a constant angular acceleration
  const double variance = config_.acceleration_radps2 * config_.acceleration_radps2;
  for (Hypothesis& hypothesis : hypotheses_) {
    hypothesis.heading_rad = wrap_angle(hypothesis.heading_rad + dt_s * hypothesis.rate_radps);
    hypothesis.covariance = F * hypothesis.covariance * F.transpose() + variance * push * push.transpose();
    hypothesis.log_weight *= std::exp(-dt_s / config_.memory_s);
  }
}

// The Kalman update with the heading alone. The hypothesis' prediction of the heading, N(psi, P), also corrects the
// frame's own distance and bearing, as far as their errors go with the heading's: with z, C the candidate's (d, theta,
// psi) and its covariance, and k = C e3 / (C33 + P),   z + k (psi - z3),   C - k (C e3)^T.
HeadingFilter::Hypothesis HeadingFilter::updated(const Hypothesis& parent, const HeadingCandidate& candidate,
                                                 std::size_t index) noexcept {
  const RelativeMeasurement& z = candidate.measurement;
  const double variance = z.covariance(2, 2);
  const double innovation = wrap_angle(z.pose.heading_rad - parent.heading_rad);
  const double S = parent.covariance(0, 0) + variance;
  const Eigen::Vector2d gain = parent.covariance.col(0) / S;
  Hypothesis child = parent;
  child.candidate = index;
  child.heading_rad = wrap_angle(parent.heading_rad + gain[0] * innovation);
  child.rate_radps += gain[1] * innovation;
  child.covariance -= gain * parent.covariance.row(0);
  child.log_weight -= 0.5 * (innovation * innovation / S + std::log(2.0 * kPi * S));

  const Eigen::Vector3d k = z.covariance.col(2) / S;
  const Eigen::Vector3d correction = -k * innovation;
  child.fused.pose = {z.pose.distance_m + correction[0], wrap_angle(z.pose.bearing_rad + correction[1]),
                      wrap_angle(z.pose.heading_rad + correction[2])};
  child.fused.covariance = z.covariance - k * z.covariance.row(2);
  return child;
}

void HeadingFilter::keep_likely(BoundedVector<Hypothesis, 2 * kKept + 2>& offspring, Kept& kept) noexcept {
  // Not std::stable_sort, which allocates.
  std::sort(offspring.begin(), offspring.end(),
            [](const Hypothesis& a, const Hypothesis& b) { return a.log_weight > b.log_weight; });
  kept.clear();
  for (const Hypothesis& child : offspring) {
    if (kept.full() || child.log_weight < offspring.front().log_weight + kDroppedLogWeight) break;
    const auto twin = std::find_if(kept.begin(), kept.end(), [&](const Hypothesis& other) {
      const double apart = wrap_angle(child.heading_rad - other.heading_rad);
      return apart * apart < child.covariance(0, 0) + other.covariance(0, 0);
    });
    if (twin == kept.end())
      kept.push_back(child);
    else
      twin->log_weight += std::log1p(std::exp(child.log_weight - twin->log_weight));
  }
  double total = 0.0;
  const double best = kept.front().log_weight;
  for (const Hypothesis& hypothesis : kept) total += std::exp(hypothesis.log_weight - best);
  for (Hypothesis& hypothesis : kept) hypothesis.log_weight -= best + std::log(total);
}

FilteredHeading HeadingFilter::update(const BoundedVector<HeadingCandidate, 2>& candidates, int degrees_of_freedom,
                                      double dt_s) noexcept {
  predict(dt_s);
  // Corners whose residual exceeds their noise are less certain than their covariance.
  const double scale = std::max(1.0, candidates.front().squared_error / std::max(degrees_of_freedom, 1));
  BoundedVector<Hypothesis, 2 * kKept + 2> offspring;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const HeadingCandidate& candidate = candidates[i];
    const double evidence =
        -0.5 * kEvidenceWeight * (candidate.squared_error - candidates.front().squared_error) / scale;
    for (const Hypothesis& parent : hypotheses_) {
      offspring.push_back(updated(parent, candidate, i));
      offspring[offspring.size() - 1].log_weight += evidence;
    }
    Hypothesis newcomer;
    newcomer.heading_rad = candidate.measurement.pose.heading_rad;
    newcomer.covariance =
        Eigen::Vector2d(candidate.measurement.covariance(2, 2), kUnknownRate_radps * kUnknownRate_radps).asDiagonal();
    newcomer.log_weight = kNewcomerLogWeight - std::log(2.0 * kPi) + evidence;
    newcomer.candidate = i;
    newcomer.fused = candidate.measurement;
    offspring.push_back(newcomer);
  }
  keep_likely(offspring, hypotheses_);

  const Hypothesis& best = hypotheses_.front();
  FilteredHeading result{best.candidate, best.fused, 1.0 - std::exp(best.log_weight)};
  for (const Hypothesis& other : hypotheses_) {
    const double apart = wrap_angle(other.heading_rad - best.heading_rad);
    result.fused.covariance(2, 2) += std::exp(other.log_weight) * apart * apart;
  }
  return result;
}

}  // namespace pilotfish::vision
