#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <type_traits>

#include "memory_asked_for.hpp"
#include "pilotfish/sim/awaited_answers.hpp"
#include "pilotfish/sim/renderer.hpp"
#include "pilotfish/sim/trajectory.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::sim;
using tests::memory_asked_for;
using tests::refused_key;

static_assert(std::is_nothrow_move_constructible_v<Renderer>);
static_assert(std::is_nothrow_move_assignable_v<Renderer>);
static_assert(std::is_copy_constructible_v<Renderer>);  // copies share what is large

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kWidth = 32, kHeight = 24;

const CameraModel kCamera{kWidth, kHeight, 30.0, 30.0, 15.5, 11.5};

Renderer renderer() { return {kCamera, {}, {}, 1}; }

TEST(Renderer, DrawsTheSameAfterAMove) {
  Renderer first = renderer();
  const auto before = first.render({View{}}, 7);
  Renderer moved = std::move(first);
  EXPECT_EQ(moved.render({View{}}, 7), before);
  first = std::move(moved);
  EXPECT_EQ(first.render({View{}}, 7), before);
  EXPECT_EQ(first.camera().width, kWidth);
}

TEST(Renderer, GivesAPictureOfItsOwnEachTime) {
  const Renderer camera = renderer();
  auto picture = camera.render({View{}}, 7);
  const auto same = picture;
  picture.assign(picture.size(), 0);
  EXPECT_EQ(camera.render({View{}}, 7), same);
  EXPECT_EQ(same.size(), std::size_t{kWidth * kHeight});
}

TEST(Renderer, HasNoPictureOfNoInstant) { EXPECT_THROW(renderer().render({}, 7), std::invalid_argument); }

TEST(Renderer, DrawsTheSameInstantTwiceAsOnce) {
  // The mean of equal gray levels is that level, and the noise has the same seed.
  const Renderer camera = renderer();
  EXPECT_EQ(camera.render({View{}, View{}}, 7), camera.render({View{}}, 7));
}

TEST(Renderer, SeesNothingOfABodyWithoutSurfaces) {
  const Renderer camera = renderer();
  const std::vector<Surface> none;
  View empty, unset;
  empty.bodies.push_back({&none, Eigen::Isometry3d::Identity()});
  unset.bodies.emplace_back();
  EXPECT_EQ(camera.render({empty}, 7), camera.render({View{}}, 7));
  EXPECT_EQ(camera.render({unset}, 7), camera.render({View{}}, 7));
}

TEST(Renderer, NamesThePartThatNoCameraHas) {
  CameraModel blind = kCamera;
  blind.fx = 0.0;
  EXPECT_EQ(refused_key([&] { Renderer(blind, {}, {}, 1); }), "camera.fx");
  Imperfections noisy;
  noisy.noise_sigma = kNone;
  EXPECT_EQ(refused_key([&] { Renderer(kCamera, {}, noisy, 1); }), "imperfections.noise_sigma");
  CameraMounting mounting;
  mounting.tilt_rad = kInfinity;
  EXPECT_EQ(refused_key([&] { Renderer(kCamera, mounting, {}, 1); }), "mounting.tilt_rad");
}

TEST(RobotBody, SaysWhichTagItsFamilyDoesNotHave) {
  RobotBody body;
  BodyTag tag;
  tag.id = 587;  // tag36h11 has 0 to 586
  body.leader.tags = {tag};
  EXPECT_THROW(surfaces_of(body), ConfigError);
  body.leader.tags[0].id = 586;
  const auto surfaces = surfaces_of(body);
  ASSERT_EQ(surfaces.size(), 1U);  // no box
  EXPECT_EQ(surfaces[0].grays.size(), 100U);
}

TEST(Unicycle, StaysWhereItIsWhenToldWhatIsNoTwistOrTime) {
  Unicycle robot{DriveConfig{}};
  robot.advance({0.3, 0.5}, 0.1);
  const UnicycleState before = robot.state();
  robot.advance({kNone, 0.0}, 0.1);
  robot.advance({0.3, kInfinity}, 0.1);
  for (double duration_s : {kNone, kInfinity, -1.0, 0.0}) robot.advance({0.3, 0.0}, duration_s);
  EXPECT_EQ(robot.state().pose.x_m, before.pose.x_m);
  EXPECT_EQ(robot.state().pose.heading_rad, before.pose.heading_rad);
  EXPECT_EQ(robot.state().twist.linear_mps, before.twist.linear_mps);
}

TEST(Unicycle, IsACopyOfItsOwn) {
  Unicycle robot{DriveConfig{}};
  robot.advance({0.3, 0.0}, 0.1);
  Unicycle copy = robot;
  copy.advance({0.3, 0.0}, 0.1);
  EXPECT_GT(copy.state().pose.x_m, robot.state().pose.x_m);
}

TEST(Unicycle, AsksForNoMemory) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  Unicycle robot{DriveConfig{}};
  EXPECT_EQ(memory_asked_for([&] { robot.advance({0.3, 0.2}, 1.0); }), 0);
}

TEST(Trajectory, StandsAtItsStartBeforeTimeBegins) {
  Line line;
  const Pose2 start{1.0, 2.0, 0.5};
  for (double time_s : {-kInfinity, -1.0, 0.0}) {
    const UnicycleState state = state_at(line, start, time_s);
    EXPECT_EQ(state.pose.x_m, 1.0) << time_s;
    EXPECT_EQ(state.twist.linear_mps, 0.0) << time_s;
  }
}

TEST(Trajectory, OfPointsThatAreOneIsOverAlthoughItRepeats) {
  Waypoints nowhere;
  nowhere.repeat = true;
  EXPECT_EQ(state_at(nowhere, {}, 1e6).pose.x_m, 0.0);  // no points
  nowhere.points = {Waypoint{}, Waypoint{}};
  EXPECT_EQ(state_at(nowhere, {}, 1e6).pose.x_m, 0.0);  // laps of 0 s
}

TEST(AwaitedAnswers, TakesTheLastAndTheFirstStampThereIs) {
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  AwaitedAnswers answers(1.0, 10.0);
  answers.sent("a", kFirst, 0.0);
  answers.sent("b", kLast, 0.0);
  EXPECT_FALSE(answers.answered("a", kLast));
  EXPECT_FALSE(answers.answered("c", kFirst));
  EXPECT_TRUE(answers.answered("a", kFirst));
  EXPECT_FALSE(answers.answered("a", kFirst));  // once
  EXPECT_TRUE(answers.answered("b", kLast));
  EXPECT_TRUE(answers.complete());
}

TEST(AwaitedAnswers, GivesUpByTheFirstPictureHoweverOftenItWasSentAgain) {
  AwaitedAnswers answers(1.0, 3.0);
  answers.sent("a", 5, 0.0);
  EXPECT_TRUE(answers.to_resend(0.5).empty());
  EXPECT_EQ(answers.to_resend(1.0).size(), 1U);
  EXPECT_TRUE(answers.to_resend(1.5).empty());  // sent again at 1.0
  EXPECT_TRUE(answers.overdue(2.9).empty());
  EXPECT_EQ(answers.overdue(3.0), std::vector<std::string>{"a"});
}

}  // namespace
