#include "pilotfish/vision/heading_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace pilotfish;
using namespace pilotfish::vision;
using Candidates = BoundedVector<HeadingCandidate, 2>;

constexpr int kOneTag = 2;  ///< degrees of freedom: eight coordinates less six of the pose

HeadingCandidate candidate(double heading_rad, double variance, double squared_error = 0.0) {
  HeadingCandidate result;
  result.measurement.pose = {2.0, 0.1, heading_rad};
  result.measurement.covariance = Eigen::Vector3d(1e-4, 1e-6, variance).asDiagonal();
  result.squared_error = squared_error;
  return result;
}

Candidates candidates(const HeadingCandidate& first) {
  Candidates result;
  result.push_back(first);
  return result;
}

Candidates candidates(const HeadingCandidate& first, const HeadingCandidate& second) {
  Candidates result = candidates(first);
  result.push_back(second);
  return result;
}

TEST(HeadingFilter, TakesTheFirstFrameAsItIs) {
  HeadingFilter filter({});
  const FilteredHeading found = filter.update(candidates(candidate(0.3, 0.01)), kOneTag, 0.0);
  EXPECT_EQ(found.candidate, 0U);
  EXPECT_EQ(found.fused.pose.heading_rad, 0.3);
  EXPECT_EQ(found.fused.covariance, candidate(0.3, 0.01).measurement.covariance);
  EXPECT_EQ(found.ambiguity, 0.0);
}

TEST(HeadingFilter, CorrectsDistanceAndBearingAsFarAsTheirErrorsGoWithTheHeadings) {
  // 0.1 s after a heading of 0 of variance 0.04, whose rate had 0.5 rad/s of standard deviation and was pushed by
  // 2 rad/s^2, the filter expects 0 with 0.04 + 0.1^2 0.25 + (0.1^2 / 2)^2 4 = 0.0426. With half of that as the
  // variance of the frame's own heading of 0.1, S = 3 C33: the heading moves back by a third of 0.1, and distance and
  // bearing by -C_i3 / S 0.1. Their variances lose C_i3^2 / S.
  HeadingFilter filter({});
  filter.update(candidates(candidate(0.0, 0.04)), kOneTag, 0.0);
  HeadingCandidate second = candidate(0.1, 0.0213);
  second.measurement.covariance(0, 2) = second.measurement.covariance(2, 0) = 1e-3;
  second.measurement.covariance(1, 2) = second.measurement.covariance(2, 1) = -1e-4;
  const FilteredHeading found = filter.update(candidates(second), kOneTag, 0.1);
  EXPECT_NEAR(found.fused.pose.heading_rad, 0.1 - 0.1 / 3.0, 1e-12);
  EXPECT_NEAR(found.fused.pose.distance_m, 2.0 - 1e-3 / 0.0639 * 0.1, 1e-12);
  EXPECT_NEAR(found.fused.pose.bearing_rad, 0.1 + 1e-4 / 0.0639 * 0.1, 1e-12);
  EXPECT_NEAR(found.fused.covariance(0, 0), 1e-4 - 1e-6 / 0.0639, 1e-12);
  EXPECT_NEAR(found.fused.covariance(0, 1), 1e-7 / 0.0639, 1e-12);
  EXPECT_NEAR(found.fused.covariance(1, 1), 1e-6 - 1e-8 / 0.0639, 1e-12);
}

TEST(HeadingFilter, KnowsOfAHeadingWhatAllFramesTogetherSay) {
  // The oracle is the same problem as one least squares: unknown are the first heading and rate and every interval's
  // acceleration, of which rate and accelerations have a prior (0.5 rad/s, 2 rad/s^2). Its last heading is the
  // filter's.
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const int frames = 12;
  HeadingFilter filter({});
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(frames + 1, frames + 1);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(frames + 1);
  information(1, 1) = 1.0 / 0.25;
  Eigen::RowVectorXd heading = Eigen::RowVectorXd::Zero(frames + 1), rate = heading;  // by the unknowns
  heading[0] = rate[1] = 1.0;
  double before_s = 0.0;
  for (int k = 0; k < frames; ++k) {
    const double at_s = 0.05 * k + 0.02 * (k % 3), dt_s = at_s - before_s, variance = 0.001 + 0.0005 * (k % 4);
    before_s = at_s;
    if (k > 0) {
      information(k + 1, k + 1) += 1.0 / 4.0;
      heading += dt_s * rate;
      heading[k + 1] += 0.5 * dt_s * dt_s;
      rate[k + 1] += dt_s;
    }
    const double measured = 0.4 * std::sin(2.0 * at_s) + std::sqrt(variance) * normal(random);
    information += heading.transpose() * heading / variance;
    right += heading.transpose() * measured / variance;
    const FilteredHeading found = filter.update(candidates(candidate(measured, variance)), kOneTag, dt_s);
    const Eigen::MatrixXd known = information.topLeftCorner(k + 2, k + 2);
    const Eigen::LDLT<Eigen::MatrixXd> solver(known);
    const Eigen::VectorXd last = heading.head(k + 2).transpose();
    EXPECT_NEAR(found.fused.pose.heading_rad, last.dot(solver.solve(right.head(k + 2))), 1e-9) << k;
    EXPECT_NEAR(found.fused.covariance(2, 2), last.dot(solver.solve(last)), 1e-9) << k;
  }
}

TEST(HeadingFilter, FollowsAHeadingThroughHalfATurn) {
  HeadingFilter filter({});
  filter.update(candidates(candidate(kPi - 0.02, 0.001)), kOneTag, 0.0);
  const FilteredHeading found = filter.update(candidates(candidate(-kPi + 0.02, 0.001)), kOneTag, 0.033);
  // Between the two, not between 3.12 and -3.12 through zero.
  EXPECT_GT(std::abs(found.fused.pose.heading_rad), kPi - 0.02);
}

TEST(HeadingFilter, TakesHalfOfTheLogLikelihoodRatioAsEvidence) {
  // Gaussian noise would say exp(-chi^2 / 2); half of that evidence counts: exp(-chi^2 / 4). With residuals of ten
  // times the variance that noise has (20 for two degrees of freedom) the difference counts a tenth; a smaller one is
  // luck. Where there are no degrees of freedom one is assumed. The two differ by 1 rad, which adds to the variance.
  struct {
    double best, other;
    int degrees_of_freedom;
  } const frames[] = {{0.0, 4.0, 2}, {1.0, 5.0, 2}, {20.0, 60.0, 2}, {10.0, 50.0, 0}};
  const double doubt = 1.0 / (1.0 + std::exp(1.0));  // all of them say exp(-1)
  for (const auto& frame : frames) {
    HeadingFilter filter({});
    const FilteredHeading found =
        filter.update(candidates(candidate(0.5, 0.01, frame.best), candidate(-0.5, 0.01, frame.other)),
                      frame.degrees_of_freedom, 0.0);
    EXPECT_EQ(found.candidate, 0U);
    EXPECT_NEAR(found.ambiguity, doubt, 1e-12) << frame.best;
    EXPECT_NEAR(found.fused.covariance(2, 2), 0.01 + doubt, 1e-12) << frame.best;
  }
}

TEST(HeadingFilter, ForgetsEvidenceWithItsTimeConstant) {
  // Evidence of exp(-1) for the first of two, and after one time constant a frame that says nothing: exp(-1 / e). That
  // one of them turned into the other within 0.1 s is out of the question: 1 rad is six standard deviations.
  HeadingFilterConfig config;
  config.memory_s = 0.1;
  HeadingFilter filter(config);
  filter.update(candidates(candidate(0.5, 0.01, 0.0), candidate(-0.5, 0.01, 4.0)), kOneTag, 0.0);
  const FilteredHeading found =
      filter.update(candidates(candidate(0.5, 0.01), candidate(-0.5, 0.01)), kOneTag, config.memory_s);
  EXPECT_NEAR(found.ambiguity, 1.0 / (1.0 + std::exp(std::exp(-1.0))), 1e-6);
}

TEST(HeadingFilter, KeepsTheSolutionThatMovesLikeARobotWhicheverFitsBetter) {
  // The true one turns at 1 rad/s, the other is its mirror image; every other frame it fits better.
  HeadingFilter filter({});
  FilteredHeading found;
  for (int k = 0; k < 30; ++k) {
    const double heading_rad = 0.1 + k / 30.0;
    const HeadingCandidate truth = candidate(heading_rad, 1e-4, 0.5), mirrored = candidate(-heading_rad, 1e-4, 0.5);
    // The first two say which one it is.
    HeadingCandidate doubted = mirrored;
    doubted.squared_error += k < 2 ? 20.0 : 0.0;
    const bool swapped = k >= 2 && k % 2 == 1;
    found = swapped ? filter.update(candidates(mirrored, truth), kOneTag, 1.0 / 30.0)
                    : filter.update(candidates(truth, doubted), kOneTag, 1.0 / 30.0);
    EXPECT_EQ(found.candidate, swapped ? 1U : 0U) << k;
    EXPECT_NEAR(found.fused.pose.heading_rad, heading_rad, 0.03) << k;
  }
}

TEST(HeadingFilter, AddsTheWeightsOfHypothesesThatAreOne) {
  // Two solutions nearer to each other than their standard deviations are one: nothing is in doubt.
  HeadingFilter filter({});
  const FilteredHeading found = filter.update(candidates(candidate(0.05, 0.01), candidate(-0.05, 0.01)), kOneTag, 0.0);
  EXPECT_NEAR(found.ambiguity, 0.0, 1e-12);
  EXPECT_NEAR(found.fused.covariance(2, 2), 0.01, 1e-12);
}

}  // namespace
