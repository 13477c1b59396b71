#include "pilotfish/control/measurement_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "memory_asked_for.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

constexpr double kClaimed_m = 5e-5, kClaimed_rad = 1e-4;

/// A leader on a circle of 1 m at 0.2 m/s, seen along the x axis, with white noise of these standard deviations.
LeaderFix fix(double time_s, const Eigen::Vector3d& sigma, std::mt19937& random) {
  std::normal_distribution<double> normal;
  LeaderFix made;
  made.utime = static_cast<std::int64_t>(std::llround(time_s * 1e6));
  const double angle = 0.2 * time_s;
  made.mean << 1.0 + std::sin(angle), std::cos(angle), angle;
  made.mean += Eigen::Vector3d(normal(random), normal(random), normal(random)).cwiseProduct(sigma);
  made.covariance =
      Eigen::Vector3d(kClaimed_m * kClaimed_m, kClaimed_m * kClaimed_m, kClaimed_rad * kClaimed_rad).asDiagonal();
  return made;
}

/// What is learned from `seconds` of frames at 30 Hz, whose distances vary by `jitter` of the period.
MeasurementNoise learned(const Eigen::Vector3d& sigma, double seconds, double jitter = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-jitter, jitter);
  MeasurementNoise noise;
  for (int k = 0; k < 30 * seconds; ++k) noise.add(fix((k + off(random)) / 30.0, sigma, random));
  return noise;
}

TEST(MeasurementNoise, AddsNothingToMeasurementsThatAreAsExactAsTheySay) {
  // Less than the claimed variance: what is subtracted is twice the claim, and the median of 60 samples is good to
  // half.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Eigen::Vector3d excess = learned({kClaimed_m, kClaimed_m, kClaimed_rad}, 10.0, 0.0, seed).excess_sigma();
    EXPECT_LT(excess(0), kClaimed_m) << seed;
    EXPECT_LT(excess(1), kClaimed_m) << seed;
    EXPECT_LT(excess(2), kClaimed_rad) << seed;
  }
}

TEST(MeasurementNoise, IsLearnedAlongTheLineOfSightAcrossItAndForTheHeadingEachByItself) {
  // The median of 60 squares that overlap is good to about half, so a standard deviation to a quarter; the mean of 20
  // seeds to 6 %.
  const Eigen::Vector3d sigma(4e-4, 2e-4, 3e-3);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (unsigned seed = 1; seed <= 20; ++seed) sum += learned(sigma, 10.0, 0.0, seed).excess_sigma();
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum(axis) / 20.0 / sigma(axis), 1.0, 0.15) << axis;
}

TEST(MeasurementNoise, IsLearnedWhateverTheTimesBetweenFramesAre) {
  const Eigen::Vector3d sigma(4e-4, 2e-4, 3e-3);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (unsigned seed = 1; seed <= 20; ++seed) sum += learned(sigma, 10.0, 0.3, seed).excess_sigma();
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum(axis) / 20.0 / sigma(axis), 1.0, 0.15) << axis;
}

TEST(MeasurementNoise, TurnsWithTheLineOfSight) {
  // Seen along y, what is along the line of sight is noise in y: the covariance's second number.
  const MeasurementNoise noise = learned({1e-3, 0.0, 0.0}, 10.0);
  const double variance = noise.excess_sigma()(0) * noise.excess_sigma()(0);
  const Eigen::Matrix3d ahead = noise.excess_covariance(0.0), left = noise.excess_covariance(std::acos(0.0));
  EXPECT_NEAR(ahead(0, 0), variance, 1e-12);
  EXPECT_NEAR(left(1, 1), variance, 1e-12);
  EXPECT_NEAR(left(0, 0), ahead(1, 1), 1e-12);
}

TEST(MeasurementNoise, IsNotDisturbedByALeaderThatStopsDeadOrByHeadingsThatFlip) {
  std::mt19937 random(3);
  MeasurementNoise noise;
  for (int k = 0; k < 150; ++k) {
    // Stopped since frame 140, and every 20th heading is 40 degrees off: at most 16 of the last 60 third differences.
    LeaderFix seen = fix(std::min(k, 140) / 30.0, {kClaimed_m, kClaimed_m, kClaimed_rad}, random);
    seen.utime = k * 33'333;
    if (k % 20 == 0) seen.mean(2) += 0.7;
    noise.add(seen);
  }
  EXPECT_LT(noise.excess_sigma()(0), 2.0 * kClaimed_m);
  EXPECT_LT(noise.excess_sigma()(1), 2.0 * kClaimed_m);
  EXPECT_LT(noise.excess_sigma()(2), 4.0 * kClaimed_rad);
}

TEST(MeasurementNoise, CountsHeadingsAcrossTheTurnOfPi) {
  std::mt19937 random(4);
  MeasurementNoise noise;
  for (int k = 0; k < 100; ++k) {
    LeaderFix seen = fix(k / 30.0, Eigen::Vector3d::Zero(), random);
    seen.mean(2) = std::remainder(3.1 + 0.01 * k, 2.0 * std::acos(-1.0));  // passes pi at frame 4 and goes on
    noise.add(seen);
  }
  EXPECT_EQ(noise.excess_sigma()(2), 0.0);
}

TEST(MeasurementNoise, TakesNoDifferenceOverAGapOrBackwardsInTime) {
  std::mt19937 random(5);
  MeasurementNoise noise;
  for (int k = 0; k < 100; ++k) {
    LeaderFix seen = fix(0.0, Eigen::Vector3d::Zero(), random);
    seen.utime = (k % 3) * 33'333 - k * 10'000'000;  // three frames, then 10 s back: never four in a row
    seen.mean(0) += k;
    noise.add(seen);
  }
  EXPECT_EQ(noise.excess_sigma(), Eigen::Vector3d::Zero());
}

TEST(MeasurementNoise, KeepsWhatItHasLearnedWhenItIsInterrupted) {
  MeasurementNoise noise = learned({1e-3, 1e-3, 1e-2}, 5.0);
  const Eigen::Vector3d before = noise.excess_sigma();
  noise.interrupt();
  EXPECT_GT(before(0), 5e-4);
  EXPECT_EQ(noise.excess_sigma(), before);
}

TEST(MeasurementNoise, StaysFiniteWhateverItIsGivenAndAsksForNoMemory) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  MeasurementNoise noise = learned({1e-3, 1e-3, 1e-2}, 5.0);
  const double nan = std::nan("");
  LeaderFix odd;
  odd.utime = 10'000'000;
  EXPECT_EQ(tests::memory_asked_for([&] {
              for (int k = 0; k < 200; ++k) {
                odd.utime += 1;
                odd.mean(k % 3) = k % 2 ? nan : 1e300;
                noise.add(odd);
              }
            }),
            0);
  EXPECT_TRUE(noise.excess_covariance(0.3).allFinite());
}

}  // namespace
