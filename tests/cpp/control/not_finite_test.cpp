// A number that is none must stand the robot still, whoever made it: the law, the measurement or the setpoint.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "even_controller.hpp"
#include "pilotfish/control/follower.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::int64_t kPeriod_us = 100'000;

const Twist kNotFinite[] = {{kInf, 0.0}, {-kInf, 0.0}, {0.0, kInf}, {0.0, -kInf}, {kNaN, 0.0}, {0.1, kNaN}};

/// Drives at 0.1 m/s, but says something else from one call on.
class ScriptedLaw final : public Law {
 public:
  explicit ScriptedLaw(const Twist& says) : says_(says) {}
  Twist follow(const Observation&, const Setpoint&, double) noexcept override {
    return ++calls_ == 3 ? says_ : Twist{0.1, 0.0};
  }
  void restart() noexcept override { restarted_ = true; }

 private:
  Twist says_;
  int calls_ = 0;
  bool restarted_ = false;
};

FollowerConfig driven_by_a_law_that_says(const Twist& twist) {
  FollowerConfig config;
  config.active_law = "scripted";
  config.laws.push_back(
      {"scripted", "", {}, [twist](const auto&, const auto&) { return std::make_unique<ScriptedLaw>(twist); }});
  return config;
}

FollowerConfig fuzzy_config(Profile profile) {
  FollowerConfig config;
  config.profile = profile;
  config.law = tests::even_controller();
  return config;
}

Observation seen(int number, double distance_m = 2.0, double bearing_rad = 0.1) {
  Observation observation;
  observation.utime = number * kPeriod_us;
  observation.distance_m = distance_m;
  observation.bearing_rad = bearing_rad;
  observation.covariance = Eigen::Vector3d(1e-5, 1e-6, 1e-4).asDiagonal();
  observation.measured.pose = {distance_m, bearing_rad, 0.0};
  observation.measured.covariance = observation.covariance;
  return observation;
}

TEST(Limit, StandsStillWhenAskedForWhatIsNoNumber) {
  for (const Twist& wanted : kNotFinite) EXPECT_EQ(limit({}, wanted, {0.3, 0.2}, 0.1), Twist{}) << wanted.linear_mps;
}

TEST(Limit, StaysWithinTheLimitsWhateverWasBefore) {
  const LimitsConfig limits;
  for (const Twist& previous : kNotFinite)
    for (double dt_s : {0.0, 0.1, kNaN, kInf, -kInf}) {
      const Twist command = limit(limits, {0.1, 0.1}, previous, dt_s);
      ASSERT_TRUE(is_finite(command));
      EXPECT_LE(std::abs(command.linear_mps), 0.1);  // never more than was asked for, from standstill
      EXPECT_LE(std::abs(command.angular_radps), 0.1);
    }
}

TEST(Follower, StandsStillAndSaysWhyWhenItsLawIsNotFinite) {
  for (const Twist& twist : kNotFinite) {
    Follower follower(driven_by_a_law_that_says(twist));
    for (int i = 0; i < 2; ++i) EXPECT_EQ(follower.follow(seen(i), {}).reason, Reason::none);
    const FollowerOutput failed = follower.follow(seen(2), {});
    EXPECT_EQ(failed.command, Twist{});
    EXPECT_EQ(failed.reason, Reason::law_not_finite);
  }
}

TEST(Follower, GoesOnFromRestAfterItsLawWasNotFinite) {
  // 1 m/s2 over a control period of 1/30 s, as at the first frame of all: the wheels were told to stand still.
  Follower follower(driven_by_a_law_that_says({kInf, 0.0}));
  const Twist first = follower.follow(seen(0), {}).command;
  for (int i = 1; i < 3; ++i) follower.follow(seen(i), {});
  const FollowerOutput after = follower.follow(seen(3), {});
  EXPECT_EQ(after.reason, Reason::none);
  EXPECT_EQ(after.command, first);
}

TEST(Follower, StandsStillWhenAMeasurementOrASetpointIsNoNumber) {
  for (Profile profile : {Profile::paper, Profile::anticipate})
    for (double number : {kNaN, kInf, -kInf}) {
      Setpoint distance, bearing;
      distance.distance_m = number;
      bearing.bearing_rad = number;
      const std::pair<Observation, Setpoint> cases[] = {
          {seen(1, number), {}}, {seen(1, 2.0, number), {}}, {seen(1), distance}, {seen(1), bearing}};
      for (const auto& [observation, setpoint] : cases) {
        Follower follower(fuzzy_config(profile));
        EXPECT_FALSE(follower.follow(seen(0), {}).command == Twist{});
        const FollowerOutput output = follower.follow(observation, setpoint);
        EXPECT_EQ(output.command, Twist{});
        EXPECT_EQ(output.reason, Reason::law_not_finite);
      }
    }
}

TEST(Follower, StaysWithinItsLimitsForNumbersWithoutMeasure) {
  for (Profile profile : {Profile::paper, Profile::anticipate}) {
    Follower follower(fuzzy_config(profile));
    for (int i = 0; i < 4; ++i) {
      const Twist command = follower.follow(seen(i, 1e308, i % 2 ? 1e308 : -1e308), {}).command;
      EXPECT_TRUE(is_finite(command));
      EXPECT_LE(std::abs(command.linear_mps), LimitsConfig{}.max_linear_mps);
    }
  }
}

}  // namespace
