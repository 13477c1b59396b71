#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pilotfish/core/robot_name.hpp"
#include "pilotfish/core/sections.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;

struct Wheel {  // as the macros write it
  double radius_m = 0.05;
  static const std::vector<Parameter<Wheel>>& parameters() {
    static const std::vector<Parameter<Wheel>> table = {{"radius_m", &Wheel::radius_m, 0.01, 0.5, ""}};
    return table;
  }
};
struct Axle {  // has no numbers of its own
  Wheel left, right;
  template <class Visit>
  static void sections(Visit&& visit) {
    visit("left", &Axle::left);
    visit("", &Axle::right);  // stands in the section itself
  }
};
struct Robot {
  PILOTFISH_PARAMETERS(Robot);
  PILOTFISH_PARAMETER(int, wheels, 2, 1, 4, "on the ground");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, painted, true, "");
  Axle axle;  // what is no parameter may stand between them

  PILOTFISH_PARAMETER_WITHOUT_RANGE(std::string, colour, "a text has no range",
                                    "the name of a colour, in a text that is too long for one line "
                                    "of it");
  PILOTFISH_PARAMETER(Vector3, position_m, {}, -1, 1, "");
  template <class Visit>
  static void sections(Visit&& visit) {
    visit("axle", &Robot::axle);
  }
};

static_assert(kHasParameters<Wheel> && !kHasSections<Wheel>);
static_assert(!kHasParameters<Axle> && kHasSections<Axle>);
static_assert(std::is_base_of_v<std::invalid_argument, ConfigError>);  // caught by who knows nothing of Pilotfish

using tests::refused_key;
std::string refused_key(const Robot& robot, const std::string& section) {
  return refused_key([&] { check_tree(robot, section); });
}

static_assert(std::is_aggregate_v<Robot>);
static_assert(std::is_same_v<decltype(Robot::wheels), int>);

TEST(Parameters, AreTheMembersInTheirOrder) {
  const std::vector<Parameter<Robot>>& table = Robot::parameters();
  std::vector<std::string_view> keys;
  for (const Parameter<Robot>& each : table) keys.push_back(each.key);
  EXPECT_EQ(keys, (std::vector<std::string_view>{"wheels", "painted", "colour", "position_m"}));
  EXPECT_EQ(std::get<int Robot::*>(table[0].member), &Robot::wheels);
  EXPECT_EQ(table[0].min, 1.0);
  EXPECT_EQ(table[0].max, 4.0);
  EXPECT_EQ(table[0].text, "on the ground");
  EXPECT_EQ(table[2].text, "the name of a colour, in a text that is too long for one line of it");
  const Robot defaults;
  EXPECT_EQ(defaults.wheels, 2);
  EXPECT_EQ(defaults.colour, "a text has no range");
}

TEST(Outside, IsSaidOfWhatIsNotWithinBothEnds) {
  EXPECT_EQ(outside(5.0, 0.0, 5.0), std::nullopt);
  EXPECT_EQ(outside(5.5, 0.0, 5.0), "5.5 is outside [0, 5]");
  EXPECT_EQ(outside(-1, 0, 1'000'000), "-1 is outside [0, 1000000]");  // whole numbers to their last digit
  EXPECT_EQ(outside(std::nan(""), 0.0, 5.0), "nan is outside [0, 5]");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(outside(kInfinity, 0.0, kInfinity), "inf is outside [0, inf]");  // no number to work with
}

TEST(ConfigError, SaysItsKeyBeforeTheProblem) {
  const ConfigError error("vision.decimation", "2.5 is not one of 1, 2");
  EXPECT_EQ(error.key(), "vision.decimation");
  EXPECT_STREQ(error.what(), "vision.decimation: 2.5 is not one of 1, 2");
}

TEST(ConfigError, IsTheSameWhenItIsCaughtAsItsBase) {
  try {
    throw ConfigError("a.b", "wrong");
  } catch (const std::exception& error) {
    EXPECT_STREQ(error.what(), "a.b: wrong");
  }
}

TEST(CheckTree, PassesWhatIsInItsBounds) { EXPECT_NO_THROW(check_tree(Robot{}, "robot")); }

TEST(CheckTree, NamesTheNestedSectionInADottedKey) {
  Robot robot;
  robot.axle.left.radius_m = 0.6;
  EXPECT_EQ(refused_key(robot, "robot"), "robot.axle.left.radius_m");
}

TEST(CheckTree, LeavesOutASectionWithoutAName) {
  Robot robot;
  robot.axle.right.radius_m = 0.6;
  EXPECT_EQ(refused_key(robot, "robot"), "robot.axle.radius_m");
}

TEST(CheckTree, HasNoDotBeforeTheKeysOfTheRoot) {
  Robot robot;
  robot.wheels = 5;
  EXPECT_EQ(refused_key(robot, ""), "wheels");
  robot = {};
  robot.axle.left.radius_m = 0.6;
  EXPECT_EQ(refused_key(robot, ""), "axle.left.radius_m");
}

TEST(CheckRange, TakesBothBoundsAndNothingBeyondThem) {
  Wheel wheel;
  for (double bound : {0.01, 0.5}) {
    wheel.radius_m = bound;
    EXPECT_NO_THROW(check_ranges(wheel, ""));
    wheel.radius_m = std::nextafter(bound, bound < 0.1 ? 0.0 : 1.0);
    EXPECT_THROW(check_ranges(wheel, ""), ConfigError);
  }
}

TEST(CheckRange, RefusesWhatIsNotANumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (double value : {std::nan(""), infinity, -infinity}) {
    Wheel wheel{value};
    EXPECT_THROW(check_ranges(wheel, ""), ConfigError) << value;
  }
}

TEST(CheckRange, LooksAtEveryComponentOfAVector) {
  for (std::size_t i = 0; i < 3; ++i) {
    Robot robot;
    robot.position_m[i] = -1.5;
    EXPECT_EQ(refused_key(robot, "r"), "r.position_m");
  }
}

TEST(CheckRange, SaysTheValueAndWhatIsAllowed) {
  try {
    check_ranges(Wheel{0.75}, "wheel");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "wheel.radius_m: 0.75 is outside [0.01, 0.5]");
  }
}

TEST(Setpoint, MayBeAsFarToTheSideAsTheLargestBearing) {
  // cos(70 deg) = 0.342: the share of the speed that still changes the distance.
  EXPECT_NEAR(std::cos(kMaxBearing_rad), 0.342, 5e-4);
  for (double side : {-1.0, 1.0}) {
    Setpoint setpoint;
    setpoint.bearing_rad = side * kMaxBearing_rad;
    EXPECT_NO_THROW(check_ranges(setpoint, "setpoint"));
    setpoint.bearing_rad = std::nextafter(setpoint.bearing_rad, side * 2.0);
    EXPECT_EQ(refused_key([&] { check_ranges(setpoint, "setpoint"); }), "setpoint.bearing_rad");
  }
}

TEST(RobotName, IsOneWordOfUpTo32Letters) {
  for (const char* good : {"r", "robot_1", "_", "0", "ROBOT", "abcdefghijklmnopqrstuvwxyz012345"})
    EXPECT_NO_THROW(check_robot_name(good, "name")) << good;
  for (const std::string& bad : {std::string(), std::string(33, 'a'), std::string("a b"), std::string("a.b"),
                                 std::string("a/b"), std::string("a-b"), std::string("a\n"), std::string("a\0b", 3),
                                 std::string("\xC3\xA4")})  // a letter, but of two bytes
    EXPECT_EQ(refused_key([&] { check_robot_name(bad, "leader.name"); }), "leader.name") << bad;
}

TEST(RobotName, IsRefusedInWordsThatAZeroDoesNotCutOff) {
  try {
    check_robot_name(std::string("rob\0t", 5), "name");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("letters, digits and underscores"), std::string::npos) << error.what();
  }
}

TEST(RobotName, IsTheSameChannelInCapitalsAndInSmallLetters) {
  EXPECT_EQ(channel_word("robot_1"), "ROBOT_1");
  EXPECT_EQ(channel_word("Robot_1"), channel_word("rOBOT_1"));
  EXPECT_EQ(channel_word(""), "");
}

}  // namespace
