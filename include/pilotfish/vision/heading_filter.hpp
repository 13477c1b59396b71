#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// How headings change and how long evidence lasts.
struct HeadingFilterConfig {
  static constexpr const char* kText = "How headings change and how long evidence lasts.";
  PILOTFISH_PARAMETERS(HeadingFilterConfig);
  PILOTFISH_PARAMETER(double, acceleration_radps2, 2.0, 0.01, 100.0,
                      "standard deviation of the angular acceleration of the leader relative to the coordinator");
  PILOTFISH_PARAMETER(double, memory_s, 2.0, 0.05, 60.0,
                      "time after which evidence for one of the two solutions of a flat tag has faded to 1/e");
};

/// One planar solution of one frame.
struct HeadingCandidate {
  RelativeMeasurement measurement;  ///< distance, bearing, heading
  double squared_error = 0.0;       ///< chi-squared of the corners
};

/// The candidate that the filter selects.
struct FilteredHeading {
  std::size_t candidate = 0;  ///< which of them is accepted
  RelativeMeasurement fused;  ///< that candidate, given the headings before
  double ambiguity = 0.0;     ///< weight of all other hypotheses, 0 to 1
};

/// A distant plane has two poses that explain a picture about equally well, and near the frontal view, the usual one of
/// a follower, noise determines which fits better. But only one of them moves like a robot, and the weak evidence of
/// each picture accumulates. So the leader's heading is a sum of Gaussians (Alspach and Sorenson, 1972): a few
/// hypotheses of heading and rate, each a Kalman filter; each frame's candidates, weighted by how well they explain the
/// corners, update each hypothesis; unlikely ones are dropped, similar ones merged. A value: copy it to try something
/// out.
class HeadingFilter {
 public:
  explicit HeadingFilter(const HeadingFilterConfig& config) : config_(config) {}  ///< no heading known yet

  /// `degrees_of_freedom` of the candidates' squared errors. `candidates` holds one or two, the best first.
  FilteredHeading update(const BoundedVector<HeadingCandidate, 2>& candidates, int degrees_of_freedom,
                         double dt_s) noexcept;
  void forget() noexcept { hypotheses_.clear(); }  ///< no heading is known any more

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.hypotheses_);
  }

 private:
  struct Hypothesis {
    double heading_rad = 0.0, rate_radps = 0.0;
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
    double log_weight = 0.0;
    std::size_t candidate = 0;  ///< the one it grew from
    RelativeMeasurement fused;  ///< that one, given this hypothesis
    template <class Self, class Archive>
    static void remember(Self& self, Archive& archive) {
      archive(self.heading_rad, self.rate_radps, self.covariance, self.log_weight, self.candidate, self.fused);
    }
  };
  static constexpr std::size_t kKept = 4;
  using Kept = BoundedVector<Hypothesis, kKept>;

  void predict(double dt_s) noexcept;
  static void keep_likely(BoundedVector<Hypothesis, 2 * kKept + 2>& offspring, Kept& kept) noexcept;
  static Hypothesis updated(const Hypothesis& parent, const HeadingCandidate& candidate, std::size_t index) noexcept;

  HeadingFilterConfig config_;
  Kept hypotheses_;
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
