#include "pilotfish/vision/leader_track.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pilotfish/core/angles.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::vision;

constexpr std::int64_t kSecond_us = 1'000'000;
constexpr RelativePose kHere{2.0, 0.1, 0.0};

/// Moves with (v, w) = (0.3, -0.2, 1, 0.2, 0.5, -0.4) per second in the camera frame.
Eigen::Isometry3d moving_at(double t_s) {
  Vector6d twist;
  twist << 0.3, -0.2, 1.0, 0.2, 0.5, -0.4;
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.translation() << 0.1, 0.2, 2.0;
  return se3::exp(t_s * twist) * start;
}

/// Seen at second 1 and again after `between_s`.
LeaderTrack seen_twice(double between_s, const LeaderTrackConfig& config = {}) {
  LeaderTrack track(config);
  track.update(moving_at(0.0), kHere, {}, kSecond_us);
  track.update(moving_at(between_s), kHere, {}, kSecond_us + std::llround(between_s * 1e6));
  return track;
}

bool predicts(const LeaderTrack& track, std::int64_t utime, const Eigen::Isometry3d& cMo) {
  const auto predicted = track.predict(utime);
  return predicted && predicted->isApprox(cMo, 1e-9);
}

TEST(LeaderTrack, PredictsNothingOfALeaderThatItHasNotSeen) {
  LeaderTrack track({});
  EXPECT_FALSE(track.predict(kSecond_us).has_value());
  EXPECT_EQ(track.seconds_since(kSecond_us), 0.0);
  EXPECT_FALSE(track.implausible_jump({100.0, 3.0, 0.0}, kSecond_us));
}

TEST(LeaderTrack, ExtrapolatesTheMotionBetweenTheLastTwoFrames) {
  const LeaderTrack track = seen_twice(0.1);
  EXPECT_TRUE(predicts(track, 1'100'000, moving_at(0.1)));
  EXPECT_TRUE(predicts(track, 1'150'000, moving_at(0.15)));
  // For 0.2 s; after that the motion is not known any more, and the place is the last one.
  EXPECT_TRUE(predicts(track, 1'300'000, moving_at(0.3)));
  EXPECT_TRUE(predicts(track, 1'300'001, moving_at(0.1)));
}

TEST(LeaderTrack, PredictsForAsLongAsItRemembersAndNeverBackwards) {
  const LeaderTrack track = seen_twice(0.1);
  EXPECT_TRUE(track.predict(1'600'000).has_value());  // 0.5 s after the last
  EXPECT_FALSE(track.predict(1'600'001).has_value());
  EXPECT_FALSE(track.predict(1'099'999).has_value());
}

TEST(LeaderTrack, TakesNoMotionFromFramesThatDoNotGiveIt) {
  // 0.201 s apart they do not; 0.19 s they do. At the same time, or earlier, the time between gives no speed.
  EXPECT_TRUE(predicts(seen_twice(0.201), 1'250'000, moving_at(0.201)));
  EXPECT_TRUE(predicts(seen_twice(0.19), 1'240'000, moving_at(0.24)));
  EXPECT_TRUE(predicts(seen_twice(0.0), 1'100'000, moving_at(0.0)));
  EXPECT_TRUE(predicts(seen_twice(-0.1), 1'000'000, moving_at(-0.1)));
}

TEST(LeaderTrack, TakesTheOtherPlanarSolutionForNoTurn) {
  for (double turn_rad : {0.49, 0.51}) {
    LeaderTrack track({});
    Eigen::Isometry3d turned = moving_at(0.0);
    turned.rotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY()));
    track.update(moving_at(0.0), kHere, {}, 0);
    track.update(turned, kHere, {}, 100'000);
    Eigen::Isometry3d further = turned;
    further.rotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY()));
    EXPECT_TRUE(predicts(track, 200'000, turn_rad < 0.5 ? further : turned)) << turn_rad;
  }
}

TEST(LeaderTrack, ForgetsTheMotionBeforeTheLastTwoFrames) {
  LeaderTrack track = seen_twice(0.1);
  track.update(moving_at(0.4), kHere, {}, 1'400'000);  // 0.3 s later
  EXPECT_TRUE(predicts(track, 1'450'000, moving_at(0.4)));
}

TEST(LeaderTrack, LetsALeaderMoveAsFastAsTheConfigurationSays) {
  // 0.1 s after 2 m: 4 m/s and a slack of 0.1 m are 0.5 m to either side.
  const LeaderTrack track = seen_twice(0.1);
  const std::int64_t utime = 1'200'000;
  EXPECT_FALSE(track.implausible_jump({2.499, 0.1, 0.0}, utime));
  EXPECT_TRUE(track.implausible_jump({2.501, 0.1, 0.0}, utime));
  EXPECT_FALSE(track.implausible_jump({1.501, 0.1, 0.0}, utime));
  EXPECT_TRUE(track.implausible_jump({1.499, 0.1, 0.0}, utime));
  // Time that was set back allows the slack alone.
  EXPECT_FALSE(track.implausible_jump({2.099, 0.1, 0.0}, 0));
  EXPECT_TRUE(track.implausible_jump({2.101, 0.1, 0.0}, 0));
}

TEST(LeaderTrack, LetsALeaderSweepAcrossAsFastAsTheCoordinatorTurns) {
  // Besides those 0.5 m, 4 rad/s at 2 m are 0.8 m in 0.1 s. 1.3 m are 0.65 rad at the nearer of the two places.
  const LeaderTrack track = seen_twice(0.1);
  const std::int64_t utime = 1'200'000;
  for (const double side : {-1.0, 1.0}) {
    EXPECT_FALSE(track.implausible_jump({2.4, 0.1 + side * 0.649, 0.0}, utime));
    EXPECT_TRUE(track.implausible_jump({2.4, 0.1 + side * 0.651, 0.0}, utime));
    EXPECT_FALSE(track.implausible_jump({1.6, 0.1 + side * (1.3 / 1.6 - 0.001), 0.0}, utime));
    EXPECT_TRUE(track.implausible_jump({1.6, 0.1 + side * (1.3 / 1.6 + 0.001), 0.0}, utime));
  }
}

TEST(LeaderTrack, MeasuresTheSweepTheShortWayRound) {
  LeaderTrack track({});
  track.update(moving_at(0.0), {2.0, kPi - 0.01, 0.0}, {}, 0);
  EXPECT_FALSE(track.implausible_jump({2.0, -kPi + 0.01, 0.0}, 0));  // 0.02 rad at 2 m are 0.04 m
}

TEST(LeaderTrack, KeepsTheAppearanceOfTheLastFrame) {
  LeaderTrack track({});
  Appearance look;
  look.black = 12.0;
  look.blur_u_px2 = 3.0;
  track.update(moving_at(0.0), kHere, look, 0);
  EXPECT_EQ(track.appearance().black, 12.0);
  EXPECT_EQ(track.appearance().blur_u_px2, 3.0);
  track.forget();
  EXPECT_FALSE(track.predict(0).has_value());
  EXPECT_FALSE(track.implausible_jump({100.0, 0.0, 0.0}, 0));
}

}  // namespace
