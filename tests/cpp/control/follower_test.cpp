#include "pilotfish/control/follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "even_controller.hpp"
#include "memory_asked_for.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

static_assert(std::is_nothrow_move_constructible_v<Follower> && std::is_nothrow_move_assignable_v<Follower>);
static_assert(!std::is_copy_constructible_v<Follower> && !std::is_copy_assignable_v<Follower>);  // it owns its law
static_assert(!std::is_convertible_v<FollowerConfig, Follower>);
static_assert(noexcept(std::declval<Follower&>().set_ego_motion(0, Twist{})));
static_assert(noexcept(std::declval<Follower&>().set_leader_intent(0, Twist{})));
static_assert(noexcept(std::declval<Follower&>().restart_on_new_clock()));

constexpr std::int64_t kPeriod_us = 33'333;

FollowerConfig config_of(Profile profile) {
  FollowerConfig config;
  config.profile = profile;
  config.law = tests::even_controller();
  return config;
}

/// A leader that drives ahead at 0.3 m/s from 1.2 m away, and a little to the left.
Observation frame(std::int64_t number, std::int64_t first_utime = 0) {
  Observation observation;
  observation.utime = first_utime + number * kPeriod_us;
  observation.distance_m = 1.2 + 0.01 * static_cast<double>(number);
  observation.bearing_rad = 0.05;
  observation.covariance = Eigen::Vector3d(1e-5, 1e-6, 1e-4).asDiagonal();
  observation.measured.pose = {observation.distance_m, observation.bearing_rad, observation.heading_rad};
  observation.measured.covariance = observation.covariance;
  return observation;
}

class EveryProfile : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Follower, EveryProfile, testing::Values(Profile::paper, Profile::anticipate),
                         [](const auto& each) { return std::string(to_string(each.param)); });

TEST_P(EveryProfile, GoesOnWithTheSameBitsAfterAMove) {
  Follower twin(config_of(GetParam())), follower(config_of(GetParam())), other(config_of(Profile::paper));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(follower.follow(frame(i), {}).command, twin.follow(frame(i), {}).command);
  Follower moved = std::move(follower);
  for (int i = 10; i < 20; ++i) EXPECT_EQ(moved.follow(frame(i), {}).command, twin.follow(frame(i), {}).command);
  other = std::move(moved);  // with its configuration
  for (int i = 20; i < 30; ++i) EXPECT_EQ(other.follow(frame(i), {}).command, twin.follow(frame(i), {}).command);
}

TEST_P(EveryProfile, GoesOnWithTheSameBitsFromACheckpoint) {
  Follower follower(config_of(GetParam())), other(config_of(GetParam()));
  for (int i = 0; i < 10; ++i) follower.follow(frame(i), {});
  Bytes bytes;
  CheckpointWriter writer(bytes);
  Follower::remember(std::as_const(follower), writer);
  CheckpointReader reader(bytes);
  Follower::remember(other, reader);
  EXPECT_TRUE(reader.read_all());
  for (int i = 10; i < 20; ++i) EXPECT_EQ(other.follow(frame(i), {}).command, follower.follow(frame(i), {}).command);
}

TEST_P(EveryProfile, AsksForNoMemoryWhileItFollows) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  Follower follower(config_of(GetParam()));
  follower.follow(frame(0), {});
  const auto asked = tests::memory_asked_for([&] {
    for (int i = 1; i < 300; ++i) {
      follower.set_ego_motion(frame(i).utime, {0.1, 0.0});
      follower.set_leader_intent(frame(i).utime, {0.3, 0.0});
      follower.follow(frame(i), {});
      if (i % 50 == 0) follower.restart(frame(i).utime);
    }
  });
  EXPECT_EQ(asked, 0);
}

TEST_P(EveryProfile, StaysWithinTheLimitsAtTheEndsOfTime) {
  // 2^64 us between two frames: the difference of the stamps does not fit into an int64.
  Follower follower(config_of(GetParam()));
  const LimitsConfig limits;
  for (std::int64_t first : {std::numeric_limits<std::int64_t>::min(), std::int64_t{0},
                             std::numeric_limits<std::int64_t>::max() - 3 * kPeriod_us})
    for (int i = 0; i < 3; ++i) {
      const Twist command = follower.follow(frame(i, first), {}).command;
      ASSERT_TRUE(is_finite(command)) << first;
      EXPECT_LE(command.linear_mps, limits.max_linear_mps);
      EXPECT_GE(command.linear_mps, -limits.max_reverse_mps);
      EXPECT_LE(std::abs(command.angular_radps), limits.max_angular_radps);
    }
}

TEST_P(EveryProfile, TakesTheMeasurementItselfWhereTheOneOfTheFrameAloneIsLeftOut) {
  Follower with(config_of(GetParam())), without(config_of(GetParam()));
  for (int i = 1; i < 30; ++i) {
    Observation seen = frame(i), same = frame(i);
    same.measured = RelativeMeasurement{};
    EXPECT_EQ(with.follow(seen, Setpoint{}).command, without.follow(same, Setpoint{}).command);
  }
}

TEST_P(EveryProfile, IsTheSameWheneverItBegins) {
  Follower now(config_of(GetParam())), later(config_of(GetParam()));
  const std::int64_t year_2050 = 2'524'608'000'000'000;
  for (int i = 0; i < 10; ++i) {
    const Twist a = now.follow(frame(i), {}).command, b = later.follow(frame(i, year_2050), {}).command;
    // Seconds since then are known to about 5e-7 s (2^-21), against 1 m/s2 and 10 rad/s2.
    EXPECT_NEAR(a.linear_mps, b.linear_mps, 1e-5);
    EXPECT_NEAR(a.angular_radps, b.angular_radps, 1e-4);
  }
}

TEST(Follower, NamesTheSectionOfWhatIsOutOfRange) {
  FollowerConfig config = config_of(Profile::paper);
  config.limits.max_linear_mps = -1.0;
  try {
    Follower{config};
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.key(), "control.limits.max_linear_mps");
  }
}

TEST(Follower, ProvesItsFuzzyLawAndLeavesTheCallersAlone) {
  const FollowerConfig config = config_of(Profile::paper);
  Follower follower(config);
  EXPECT_EQ(config.law.plan, nullptr);
  EXPECT_TRUE(is_finite(follower.follow(frame(0), {}).command));
}

TEST(Follower, DrivesForwardToALeaderThatIsTooFar) {
  // e = 1.0 - 1.2 = -0.2 m: too far. ec = 0 at the first frame. The limit of 1 m/s2 allows 1/30 m/s after one period.
  Follower follower(config_of(Profile::paper));
  EXPECT_NEAR(follower.follow(frame(0), {}).command.linear_mps, 1.0 / 30.0, 1e-9);
}

TEST(Profile, HasANameThatLeadsBackToIt) {
  for (Profile profile : {Profile::paper, Profile::anticipate}) EXPECT_EQ(profile_from(to_string(profile)), profile);
  EXPECT_THROW(profile_from("Paper"), ConfigError);
}

}  // namespace
