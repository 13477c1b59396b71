#include "pilotfish/control/own_motion_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

namespace {

using pilotfish::control::OwnMotionNoise;

constexpr std::int64_t kPeriod_us = 33'333;
constexpr double kPeriod_s = 1e-6 * kPeriod_us;

/// After `frames` measurements with noise of `noise_m` of a leader that is `ahead_m` away at time t [s], by a robot
/// whose place drifts with `walk` [m per sqrt(s)]; every frame is lost with that probability.
OwnMotionNoise learned(double noise_m, double walk, unsigned seed, const std::function<double(double)>& ahead_m,
                       int frames = 240, double lost = 0.0) {
  OwnMotionNoise learned;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  double strayed_m = 0.0;
  for (int i = 0; i < frames; ++i) {
    strayed_m += walk * std::sqrt(kPeriod_s) * normal(random);
    const double measured_m = ahead_m(kPeriod_s * i) + strayed_m + noise_m * normal(random);
    if (uniform(random) >= lost) learned.add(kPeriod_us * (i + 1), {measured_m, 0.0}, 0.0);
  }
  return learned;
}

double constant_speed(double t) { return 1.1 + 0.2 * t; }

/// Over 40 seeds.
double mean_sigma(double noise_m, double walk, const std::function<double(double)>& ahead_m, double lost = 0.0) {
  double sum = 0.0;
  for (unsigned seed = 1; seed <= 40; ++seed) sum += learned(noise_m, walk, seed, ahead_m, 240, lost).sigma();
  return sum / 40.0;
}

TEST(OwnMotionNoise, FindsAWalkThatIsMuchMoreThanTheNoise) {
  // 1 mm per sqrt(s) is 0.17 mm from frame to frame, beside 0.02 mm of noise. Medians of some 30 independent values,
  // two of them: each walk is found to a third, their mean to a tenth.
  EXPECT_NEAR(mean_sigma(2e-5, 1e-3, constant_speed), 1e-3, 1.5e-4);
}

TEST(OwnMotionNoise, FindsLessOfAWalkThatTheNoiseHides) {
  // s^2 = 0.01 mm^2 beside q W_6 = 0.25 x 0.06: what is found lies between nothing and all of it.
  const double found = mean_sigma(1e-4, 5e-4, constant_speed);
  EXPECT_GT(found, 0.0);
  EXPECT_LT(found, 5e-4);
}

TEST(OwnMotionNoise, FindsNextToNothingInNoiseAlone) {
  // 0.05 mm, as a picture at 1.1 m: a walk that made as much from frame to frame would be 0.27 mm per sqrt(s).
  EXPECT_LT(mean_sigma(5e-5, 0.0, constant_speed), 1e-4);
}

TEST(OwnMotionNoise, TakesNoSmoothMotionOfTheLeaderForIt) {
  // On a circle of 1 m at 0.2 m/s: the third difference is v^3 / R^2 x t^3 = 64 um over three times 0.2 s, r 14 um.
  const auto on_circle = [](double t) { return 1.1 + std::sin(0.2 * t); };
  EXPECT_LT(mean_sigma(2e-5, 0.0, on_circle), 1e-4);
  const auto braking = [](double t) { return 1.1 + 0.2 * t - 0.1 * t * t; };
  EXPECT_LT(mean_sigma(2e-5, 0.0, braking), 1e-4);
}

TEST(OwnMotionNoise, TakesNoLeaderThatStopsDeadForIt) {
  // The stop is in 18 of 120 samples.
  const auto stops = [](double t) { return 1.1 + 0.2 * std::min(t, 6.0); };
  EXPECT_LT(mean_sigma(2e-5, 0.0, stops), 1e-4);
}

TEST(OwnMotionNoise, KnowsTheTimesOfFramesThatWereLost) {
  EXPECT_NEAR(mean_sigma(2e-5, 1e-3, constant_speed, 0.3), 1e-3, 2e-4);
}

TEST(OwnMotionNoise, IsBounded) { EXPECT_EQ(learned(2e-5, 0.05, 1, constant_speed).sigma(), OwnMotionNoise::kMax); }

TEST(OwnMotionNoise, SaysNothingUntilEnoughIsKnown) {
  const int needed = static_cast<int>(OwnMotionNoise::kMinSamples) + 18;  // the first sample takes 19 measurements
  EXPECT_EQ(learned(2e-5, 1e-3, 3, constant_speed, needed - 1).sigma(), 0.0);
  EXPECT_GT(learned(2e-5, 1e-3, 3, constant_speed, needed).sigma(), 0.0);
}

TEST(OwnMotionNoise, LooksAlongTheLineOfSight) {
  OwnMotionNoise along, across;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double strayed_m = 0.0;
  for (int i = 0; i < 240; ++i) {
    strayed_m += 1e-3 * std::sqrt(kPeriod_s) * normal(random);
    along.add(kPeriod_us * (i + 1), {1.1, strayed_m}, M_PI / 2.0);
    across.add(kPeriod_us * (i + 1), {1.1, strayed_m}, 0.0);
  }
  EXPECT_GT(along.sigma(), 5e-4);
  EXPECT_EQ(across.sigma(), 0.0);
}

TEST(OwnMotionNoise, KeepsWhatItLearnedOverAGapAndComparesNothingAcrossIt) {
  OwnMotionNoise noise = learned(2e-5, 1e-3, 7, constant_speed);
  const double before = noise.sigma();
  ASSERT_GT(before, 0.0);
  noise.interrupt();
  for (int i = 0; i < 18; ++i) noise.add(1'000'000'000 + kPeriod_us * i, {100.0 * i, 0.0}, 0.0);
  EXPECT_EQ(noise.sigma(), before) << "18 measurements make no difference of 19";
  for (int i = 0; i < 200; ++i) noise.add(2'000'000'000 + 600'000 * i, {i % 2 * 1.0, 0.0}, 0.0);
  EXPECT_EQ(noise.sigma(), before) << "0.6 s apart";
  noise.add(5, {0.0, 0.0}, 0.0);  // older than the last
  EXPECT_EQ(noise.sigma(), before);
}

}  // namespace
