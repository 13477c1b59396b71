// A coordinator that may follow another leader: what it commands, and when.

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "even_controller.hpp"
#include "memory_asked_for.hpp"
#include "pilotfish/coordinator/coordinator.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;
using Seen = std::optional<double>;  // the leader's distance [m], straight ahead

constexpr std::int64_t kPeriod_us = 40'000;
const Seen kNobody;

CoordinatorConfig config(double back_after_s = 0.0) {
  CoordinatorConfig config;
  config.camera = {640, 480, 600.0, 600.0, 319.5, 239.5};
  config.leader.tags.push_back({});
  config.control.law = tests::even_controller();
  config.alternatives.after_lost_s = 1.0;
  config.alternatives.back_after_s = back_after_s;
  for (int id : {10, 20}) {
    AlternativeLeader& other = config.other_leaders.emplace_back();
    other.distance_m = 1.5;
    other.leader.name = "wears " + std::to_string(id);
    other.leader.tags.push_back({});
    other.leader.tags.back().id = id;
  }
  return config;
}

/// A camera at 25 Hz; the stamps are the arrivals.
class Robot {
 public:
  explicit Robot(const CoordinatorConfig& config) : coordinator(config) {}

  StepResult frame(Seen first, Seen second, Seen third = kNobody) {
    utime += kPeriod_us;
    std::vector<vision::ObservationResult> seen;
    for (const Seen& distance_m : {first, second, third}) seen.push_back(result(distance_m));
    return coordinator.step_observations(utime, seen, {utime});
  }
  StepResult frames(int count, Seen first, Seen second, Seen third = kNobody) {
    StepResult last;
    for (int i = 0; i < count; ++i) last = frame(first, second, third);
    return last;
  }

  Coordinator coordinator;
  std::int64_t utime = 0;

 private:
  vision::ObservationResult result(Seen distance_m) const {
    vision::ObservationResult sight;
    sight.reason = Reason::no_tag_found;
    if (!distance_m) return sight;
    sight.reason = Reason::none;
    sight.observation.emplace();
    sight.observation->utime = utime;
    sight.observation->distance_m = *distance_m;
    sight.observation->covariance.diagonal().setConstant(1e-8);
    return sight;
  }
};

/// Has followed the first leader for two seconds, then the second one.
Robot switched(double back_after_s = 0.0) {
  Robot robot(config(back_after_s));
  robot.frames(50, 1.2, 1.8);
  const StepResult result = robot.frames(25, kNobody, 1.8);
  EXPECT_EQ(result.leader_index, 1);
  return robot;
}

TEST(Alternatives, AreOfNoEffectWhileTheLeaderIsSeen) {
  CoordinatorConfig alone = config();
  alone.other_leaders.clear();
  Robot with(config()), without(alone);
  for (int i = 0; i < 100; ++i) {
    const StepResult one = with.frame(1.2, 1.5), other = without.frame(1.2, 1.5);
    ASSERT_EQ(one.command, other.command);
    ASSERT_EQ(one.status, other.status);
    ASSERT_EQ(one.leader_index, 0);
  }
}

// The last measurement of the first leader is 100 ms old after two and a half periods; until the change nothing moves.
TEST(Alternatives, MoveNothingBeforeTheyAreFollowed) {
  Robot robot(config());
  robot.frames(50, 1.2, 1.8);
  for (int i = 1; i < 25; ++i) {
    const StepResult result = robot.frame(kNobody, 1.8);
    EXPECT_EQ(result.leader_index, 0);
    if (i < 3) continue;
    EXPECT_EQ(result.status, Status::lost);
    EXPECT_EQ(result.command, Twist{});
    EXPECT_FALSE(result.observation.has_value());
  }
  const StepResult result = robot.frame(kNobody, 1.8);
  EXPECT_EQ(result.status, Status::tracking);
  EXPECT_EQ(result.reason, Reason::leader_changed);
  EXPECT_EQ(result.leader_index, 1);
  EXPECT_EQ(result.leader_changes, 1);
  ASSERT_TRUE(result.observation && result.control);
  EXPECT_EQ(result.observation->distance_m, 1.8);
  EXPECT_EQ(result.control->setpoint.distance_m, 1.5);
  EXPECT_GT(result.command.linear_mps, 0.0);
}

TEST(Alternatives, SayThatTheyAreChecked) {
  Robot robot(config());
  robot.frames(50, 1.2, kNobody);
  EXPECT_EQ(robot.frames(30, kNobody, kNobody).reason, Reason::no_tag_found);
  EXPECT_EQ(robot.frame(kNobody, 1.8).reason, Reason::checking_another_leader);
}

TEST(Alternatives, BeginWithALeaderWhoseMotionIsUnknown) {
  Robot robot(config());
  robot.frames(50, 1.2, 1.8);
  ASSERT_TRUE(robot.frame(1.2, 1.8).control->leader.has_value());
  robot.frames(24, kNobody, 1.8);
  const StepResult first = robot.frame(kNobody, 1.8);
  ASSERT_EQ(first.leader_index, 1);
  // As a robot that has just been started behind that leader.
  CoordinatorConfig started = config();
  started.setpoint.distance_m = 1.5;
  const StepResult fresh = Robot(started).frame(1.8, kNobody);
  EXPECT_EQ(first.control->feed_forward_weight, fresh.control->feed_forward_weight);
  // But for what dead reckoning has left of its own speed; the two leaders are 0.6 m apart.
  EXPECT_NEAR(first.control->velocity.error_change_m, 0.0, 1e-3);
  EXPECT_EQ(first.command, fresh.command);
}

TEST(Alternatives, KeepTheSpeedWhenTheFirstLeaderTakesOver) {
  Robot robot = switched(1.0);
  StepResult before, now;
  for (int i = 0; i == 0 || (i < 60 && now.leader_index != 0); ++i) {
    before = now;
    now = robot.frame(1.6, 1.9);
  }
  ASSERT_EQ(now.leader_index, 0);
  ASSERT_EQ(before.status, Status::tracking);
  // 1 m/s2 for one period, the limits' default; the command does not begin from rest.
  EXPECT_NEAR(now.command.linear_mps, before.command.linear_mps, 1.0 * 0.04 + 1e-9);
}

TEST(Alternatives, AreNotTakenWhereTheyCannotBeFollowed) {
  Robot near(config()), far(config());
  near.frames(50, 1.2, kNobody);
  far.frames(50, 1.2, kNobody);
  EXPECT_EQ(near.frames(100, kNobody, 0.3, 1.8).leader_index, 2);     // below safety.stop_distance_m
  EXPECT_EQ(far.frames(100, kNobody, 5.1, kNobody).leader_index, 0);  // above vision.acquisition_range_m
}

TEST(Alternatives, AreNotTakenBeforeAnyLeaderWasSeen) {
  Robot robot(config());
  const StepResult result = robot.frames(200, kNobody, 1.8);
  EXPECT_EQ(result.status, Status::searching);
  EXPECT_EQ(result.leader_index, 0);
  EXPECT_EQ(result.command, Twist{});
}

TEST(Alternatives, AreNotTakenWhileItIsStopped) {
  Robot robot(config());
  robot.frames(50, 1.2, 1.8);
  robot.coordinator.set_setpoint({1.0, 0.0, false});
  EXPECT_EQ(robot.frames(200, kNobody, 1.8).leader_index, 0);
  robot.coordinator.set_setpoint({1.0, 0.0, true});  // the time counts from here on
  EXPECT_EQ(robot.frames(24, kNobody, 1.8).leader_index, 0);
}

TEST(Alternatives, HaveSetpointsOfTheirOwn) {
  Robot robot = switched();
  EXPECT_EQ(robot.coordinator.setpoint().distance_m, 1.5);
  EXPECT_TRUE(robot.coordinator.set_setpoint({1.7, 0.1, true}));
  EXPECT_EQ(robot.frame(kNobody, 1.8).control->setpoint.distance_m, 1.7);
  EXPECT_EQ(robot.frames(60, 1.2, kNobody).control->setpoint.distance_m, 1.0);  // back, with what it had
}

TEST(Alternatives, DoNotListenToWhatTheFirstLeaderAnnounces) {
  Robot robot = switched();
  EXPECT_FALSE(robot.coordinator.set_leader_intent(robot.utime + 1, {0.1, 0.0}));
  robot.frames(60, 1.2, kNobody);
  EXPECT_TRUE(robot.coordinator.set_leader_intent(robot.utime + 1, {0.1, 0.0}));
}

TEST(Alternatives, AreRememberedBitForBit) {
  Robot robot = switched(2.0);
  Robot twin(config(2.0));
  ASSERT_TRUE(twin.coordinator.set_memory(robot.coordinator.memory()));
  twin.utime = robot.utime;
  for (int i = 0; i < 100; ++i) ASSERT_EQ(robot.frame(1.2, 1.8).command, twin.frame(1.2, 1.8).command);
  EXPECT_EQ(twin.coordinator.leader_changes(), 2);
  EXPECT_EQ(robot.coordinator.memory().decisions, twin.coordinator.memory().decisions);
}

TEST(Alternatives, AskForNoMemoryWhileTheyAreFollowed) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  Robot robot = switched(1.0);
  std::vector<vision::ObservationResult> seen(3);
  robot.frames(10, 1.2, 1.8);
  seen[1].observation.emplace().distance_m = 1.8;
  const std::int64_t asked = tests::memory_asked_for([&] {
    for (int i = 0; i < 100; ++i) {
      robot.utime += kPeriod_us;
      seen[1].observation->utime = robot.utime;
      robot.coordinator.step_observations(robot.utime, seen, {robot.utime});
    }
  });
  EXPECT_EQ(asked, 0);
}

TEST(Alternatives, AreRefusedByTheKeyThatIsWrong) {
  const auto key = [](auto&& change) {
    CoordinatorConfig changed = config();
    change(changed);
    return tests::refused_key([&] { const Coordinator refused(changed); });
  };
  using C = CoordinatorConfig;
  EXPECT_EQ(key([](C&) {}), "nothing");
  EXPECT_EQ(key([](C& c) { c.other_leaders[1].leader.tags[0].id = 0; }), "alternatives.leaders[1].leader");
  EXPECT_EQ(key([](C& c) { c.other_leaders[1].leader.tags[0].id = 10; }), "alternatives.leaders[1].leader");
  EXPECT_EQ(key([](C& c) { c.other_leaders[0].leader.family = "tag25h9"; }), "alternatives.leaders[0].leader");
  EXPECT_EQ(key([](C& c) { c.other_leaders[0].leader.tags[0].id = 600; }), "alternatives.leaders[0].leader.tags[0].id");
  EXPECT_EQ(key([](C& c) { c.other_leaders[0].leader.tags.clear(); }), "alternatives.leaders[0].leader.tags");
  EXPECT_EQ(key([](C& c) { c.other_leaders[0].distance_m = 0.3; }), "alternatives.leaders[0].distance_m");
  EXPECT_EQ(key([](C& c) { c.other_leaders[0].distance_m = 30.0; }), "alternatives.leaders[0].distance_m");
  EXPECT_EQ(key([](C& c) { c.other_leaders[1].bearing_rad = 1.3; }), "alternatives.leaders[1].bearing_rad");
  EXPECT_EQ(key([](C& c) { c.alternatives.after_lost_s = 0.1; }), "alternatives.after_lost_s");
  EXPECT_EQ(key([](C& c) { c.alternatives.back_after_s = 0.5; }), "alternatives.back_after_s");
}

}  // namespace
