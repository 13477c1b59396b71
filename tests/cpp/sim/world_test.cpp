#include "pilotfish/sim/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <type_traits>

#include "pilotfish/sim/recorder.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::sim;
using tests::refused_key;

static_assert(std::is_move_constructible_v<World>);
static_assert(!std::is_copy_constructible_v<World>);

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

CameraSpec camera() {
  CameraSpec spec;
  spec.model = {32, 24, 30.0, 30.0, 15.5, 11.5};
  return spec;
}

/// A leader that drives away with 0.2 m/s at once, and a follower 2 m behind it that can reach any speed at once.
Scenario two_robots() {
  RobotSpec leader, follower;
  leader.name = "leader";
  leader.start.x_m = 2.0;
  Line line;
  line.profile.speed_mps = 0.2;
  line.profile.acceleration_mps2 = 1e3;
  leader.trajectory = line;
  leader.body.emplace();
  leader.body->leader.name = "leader";
  leader.body->leader.tags.push_back({});
  follower.name = "robot1";
  follower.follows = "leader";
  follower.camera = camera();
  Scenario scenario;
  scenario.name = "two";
  scenario.robots = {leader, follower};
  return scenario;
}

std::vector<std::uint8_t> pixels(const Frame& frame) {
  return {frame.image.data, frame.image.data + frame.image.size_bytes};
}

TEST(World, GoesOnWhereItWasAfterAMove) {
  World world(two_robots()), still(two_robots());
  for (World* each : {&world, &still}) {
    ASSERT_TRUE(each->command("robot1", {0.3, 0.0}, 0.05));
    each->advance_to(0.1);
  }
  // Robots point into the scenario, which moves along: its robots must not be those of the world before.
  World moved = std::move(world);
  for (World* each : {&moved, &still}) each->advance_to(0.2);
  EXPECT_EQ(moved.state("robot1").pose.x_m, still.state("robot1").pose.x_m);
  EXPECT_EQ(moved.true_cMo("robot1").matrix(), still.true_cMo("robot1").matrix());
  EXPECT_EQ(pixels(*moved.capture("robot1")), pixels(*still.capture("robot1")));
}

TEST(World, GivesAFrameThatOutlivesIt) {
  std::optional<Frame> frame;
  std::vector<std::uint8_t> then;
  {
    const World world(two_robots());
    frame = world.capture("robot1");
    then = pixels(*frame);
  }
  EXPECT_EQ(frame->utime, kStartUtime);
  EXPECT_EQ(check(frame->image), Reason::none);
  EXPECT_EQ(pixels(*frame), then);
}

TEST(World, CanBeAskedThroughAConstReferenceAndIsNotChangedByIt) {
  const World world(two_robots());
  EXPECT_EQ(pixels(*world.capture("robot1")), pixels(*world.capture("robot1")));
  EXPECT_EQ(world.true_relative_pose("robot1").distance_m, 2.0);
  EXPECT_EQ(world.frame_index(), 0);
}

TEST(World, KeepsItsScenarioFromWhoeverGaveIt) {
  Scenario scenario = two_robots();
  const World world(scenario);
  scenario.robots[0].start.x_m = 9.0;
  scenario.robots.clear();
  EXPECT_EQ(world.state("leader").pose.x_m, 2.0);
}

TEST(World, HasItsTimeWithinAnInt64WhateverItIsToldToAdvanceTo) {
  World world(two_robots());
  world.advance_to(1.0);
  // 1e300 s are no microseconds of an int64; kNever_s is as far as a scenario goes.
  for (double time_s : {kInfinity, kNone, 1e300, std::nextafter(kNever_s, kInfinity), -kInfinity, 0.5}) {
    world.advance_to(time_s);
    EXPECT_EQ(world.utime(), kStartUtime + 1'000'000) << time_s;
    EXPECT_EQ(world.frame_index(), 30) << time_s;
  }
}

TEST(World, RefusesCommandsThatAreNoneAndStaysAsItWas) {
  World world(two_robots());
  EXPECT_FALSE(world.command("robot1", {kNone, 0.0}, 0.0));
  EXPECT_FALSE(world.command("robot1", {0.1, kInfinity}, 0.0));
  EXPECT_FALSE(world.command("robot1", {0.1, 0.0}, kNone));
  EXPECT_FALSE(world.command("leader", {0.1, 0.0}, 0.0));  // on rails
  world.advance_to(1.0);
  EXPECT_EQ(world.state("robot1").pose.x_m, 0.0);
}

TEST(World, SaysWhichNameItDoesNotKnow) {
  World world(two_robots());
  EXPECT_THROW(world.state("nobody"), std::out_of_range);
  EXPECT_THROW(world.command("nobody", {}, 0.0), std::out_of_range);
  EXPECT_THROW(world.capture("leader"), std::out_of_range);   // has no camera
  EXPECT_THROW(world.true_cMo("leader"), std::out_of_range);  // follows no robot
}

TEST(World, IsNotMadeOfAScenarioThatIsNotValid) {
  Scenario scenario = two_robots();
  scenario.robots[1].follows = "ghost";
  EXPECT_EQ(refused_key([&] { World world(scenario); }), "robots[1].follows");
  scenario = two_robots();
  scenario.robots[1].drive.actuator_lag_s = kNone;
  EXPECT_EQ(refused_key([&] { World world(scenario); }), "robots[1].drive.actuator_lag_s");
}

TEST(Recording, HasNoRowOfARobotThatTheWorldDoesNotHave) {
  const World world(two_robots());
  std::ostringstream csv;
  EXPECT_THROW(write_recording_row(csv, world, "nobody", {}), std::out_of_range);
  EXPECT_THROW(write_recording_row(csv, world, "leader", {}), std::out_of_range);  // follows no robot
  EXPECT_EQ(csv.str(), "");
}

TEST(Recording, LeavesThePrecisionOfItsStreamAsItWas) {
  const World world(two_robots());
  std::ostringstream csv;
  csv.precision(3);
  write_recording_row(csv, world, "robot1", {{1.0 / 3.0, 0.0}, "tracking", true});
  EXPECT_EQ(csv.precision(), 3);
  EXPECT_NE(csv.str().find(",0.33333333333333331,"), std::string::npos) << csv.str();  // 17 digits
}

}  // namespace
