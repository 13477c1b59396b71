#include "pilotfish/control/law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "even_controller.hpp"
#include "memory_asked_for.hpp"
#include "pilotfish/control/follower.hpp"
#include "pilotfish/control/pid_law.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::control;

static_assert(std::has_virtual_destructor_v<Law> && std::is_abstract_v<Law>);
static_assert(noexcept(std::declval<Law&>().follow(std::declval<const Observation&>(), Setpoint{}, 0.1)));
static_assert(noexcept(std::declval<Law&>().restart()));

Observation seen_at(double distance_m, double bearing_rad) {
  Observation observation;
  observation.distance_m = distance_m;
  observation.bearing_rad = bearing_rad;
  return observation;
}

/// Drives straight on, and counts how many of its kind there are.
class CountedLaw final : public Law {
 public:
  static inline int alive = 0;
  CountedLaw() { ++alive; }
  CountedLaw(const CountedLaw&) = delete;
  CountedLaw& operator=(const CountedLaw&) = delete;
  ~CountedLaw() override { --alive; }
  Twist follow(const Observation&, const Setpoint&, double) noexcept override { return {0.1, 0.0}; }
};

struct OwnConfig {
  double gain_per_s = 2.0;
  static const std::vector<Parameter<OwnConfig>>& parameters() {
    static const std::vector<Parameter<OwnConfig>> table = {{"gain_per_s", &OwnConfig::gain_per_s, 0.5, 4.0, "Gain."}};
    return table;
  }
};
class OwnLaw final : public Law {
 public:
  OwnLaw(const OwnConfig& config, const LimitsConfig& limits) : config_(config), limits_(limits) {}
  Twist follow(const Observation&, const Setpoint&, double) noexcept override {
    return {config_.gain_per_s, limits_.max_linear_mps};
  }

 private:
  OwnConfig config_;
  LimitsConfig limits_;
};

/// A law that counts itself, as a configuration knows it.
LawDescription counted_law(const std::string& name) {
  return {name, "", {}, [](const auto&, const auto&) { return std::make_unique<CountedLaw>(); }};
}

FollowerConfig driven_by(LawDescription law) {
  FollowerConfig config;
  config.active_law = law.name;
  config.laws.push_back(std::move(law));
  return config;
}

using tests::refused_key;

TEST(AddLaw, RefusesANameThatAFileCouldNotTellFromAnother) {
  FollowerConfig config;
  for (const std::string taken : {"fuzzy", "pid", "limits", "leader_motion"}) {
    EXPECT_EQ(refused_key([&] { add_law(config, counted_law(taken)); }), "law") << taken;
    EXPECT_EQ(law_names(config), law_names(FollowerConfig{})) << taken;
  }
  add_law(config, counted_law("own"));
  EXPECT_EQ(law_names(config).back(), "own");
  EXPECT_EQ(refused_key([&] { add_law(config, counted_law("own")); }), "law");  // it is there already
}

TEST(AddLaw, SaysWhoHasTheName) {
  FollowerConfig config;
  const auto problem = [&](const char* name) -> std::string {
    try {
      add_law(config, counted_law(name));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(problem("limits"),
            "law: 'limits' is a section of the configuration's `control`; a law of your own needs another name");
  EXPECT_EQ(problem("pid"), "law: 'pid' comes with Pilotfish; a law of your own needs another name");
}

TEST(FollowerOfOwnLaws, RefusesNamesThatWerePushedPastAddLaw) {
  for (const std::string taken : {"fuzzy", "pid", "drive"}) {
    FollowerConfig config = driven_by(counted_law(taken));
    EXPECT_EQ(refused_key([&] { Follower{config}; }), "law") << taken;
  }
}

TEST(DescribeLaw, TakesKeysBoundsAndDefaultsFromTheTable) {
  const LawDescription law = describe_law<OwnLaw, OwnConfig>("own", "My own");
  ASSERT_EQ(law.parameters.size(), 1U);
  EXPECT_EQ(law.parameters[0].key, "gain_per_s");
  EXPECT_EQ(law.parameters[0].value, 2.0);
  EXPECT_EQ(law.parameters[0].min, 0.5);
  EXPECT_EQ(law.parameters[0].max, 4.0);
  EXPECT_EQ(law.parameters[0].text, "Gain.");
}

struct CountingConfig {
  PILOTFISH_PARAMETERS(CountingConfig);
  PILOTFISH_PARAMETER(double, gain_per_s, 2.0, 0.5, 4.0, "Gain.");
  PILOTFISH_PARAMETER(int, frames, 5, 1, 100, "Frames.");
};

class CountingLaw final : public Law {
 public:
  CountingLaw(const CountingConfig&, const LimitsConfig&) {}
  Twist follow(const Observation&, const Setpoint&, double) noexcept override { return {}; }
};

TEST(DescribeLaw, NamesAParameterThatIsNoDouble) {
  const auto describe = [] { describe_law<CountingLaw, CountingConfig>("own", "My own"); };
  EXPECT_EQ(refused_key(describe), "own.frames");
}

TEST(DescribeLaw, MakesALawOfTheValuesAndTheLimits) {
  LawDescription law = describe_law<OwnLaw, OwnConfig>("own", "My own");
  set_parameter(law, "gain_per_s", 3.0);
  LimitsConfig limits;
  limits.max_linear_mps = 0.25;
  const Twist twist = law.make(law.parameters, limits)->follow({}, {}, 0.1);
  EXPECT_EQ(twist.linear_mps, 3.0);
  EXPECT_EQ(twist.angular_radps, 0.25);
}

TEST(DescribeLaw, MakesLawsThatShareNothing) {
  const LawDescription pid = describe_law<PidLaw, PidConfig>("pid", "");
  const auto one = pid.make(pid.parameters, {}), other = pid.make(pid.parameters, {});
  const Observation near = seen_at(1.01, 0.01);
  const Twist first = one->follow(near, {}, 0.1);
  one->follow(near, {}, 0.1);  // its integrals grow
  EXPECT_EQ(other->follow(near, {}, 0.1), first);
}

TEST(SetParameter, NamesTheLawAndTheParameter) {
  LawDescription law = describe_law<OwnLaw, OwnConfig>("own", "");
  EXPECT_EQ(refused_key([&] { set_parameter(law, "gain", 1.0); }), "control.own.gain");
  EXPECT_EQ(refused_key([&] { set_parameter(law, "gain_per_s", 4.5); }), "control.own.gain_per_s");
}

TEST(SetParameter, ChangesNothingWhenItRefuses) {
  LawDescription law = describe_law<OwnLaw, OwnConfig>("own", "");
  for (double value : {std::nan(""), std::nextafter(0.5, 0.0), std::nextafter(4.0, 5.0), HUGE_VAL, -HUGE_VAL})
    EXPECT_THROW(set_parameter(law, "gain_per_s", value), ConfigError) << value;
  EXPECT_EQ(law.parameters[0].value, 2.0);
  for (double bound : {0.5, 4.0}) {
    EXPECT_NO_THROW(set_parameter(law, "gain_per_s", bound));
    EXPECT_EQ(law.parameters[0].value, bound);
  }
}

TEST(PidLaw, IsItsGainsTimesTheErrorsAtTheFirstCall) {
  // 0.1 m too far and 0.2 rad to the left, one period of 0.1 s:
  // 1.5 * 0.1 + 0.6 * 0.1 * 0.1 = 0.156 m/s and 2.5 * 0.2 + 1.0 * 0.2 * 0.1 = 0.52 rad/s; no rate is known yet.
  PidLaw law({}, {});
  const Twist twist = law.follow(seen_at(1.1, 0.2), {}, 0.1);
  EXPECT_NEAR(twist.linear_mps, 0.156, 1e-12);
  EXPECT_NEAR(twist.angular_radps, 0.52, 1e-12);
}

TEST(PidLaw, GoesOnFromWhatItRemembered) {
  PidLaw law({}, {});
  for (int i = 0; i < 5; ++i) law.follow(seen_at(1.1 + 0.01 * i, 0.02 * i), {}, 0.03);
  Bytes bytes;
  CheckpointWriter writer(bytes);
  std::as_const(law).remember(writer);

  PidLaw other({}, {});
  CheckpointReader reader(bytes);
  other.remember(reader);
  EXPECT_TRUE(reader.read_all());
  for (int i = 0; i < 5; ++i) {
    const Observation next = seen_at(1.15 - 0.01 * i, 0.1);
    EXPECT_EQ(other.follow(next, {}, 0.03), law.follow(next, {}, 0.03));  // bit for bit
  }
}

TEST(PidLaw, ForgetsItsPastWhenItRestarts) {
  PidLaw law({}, {}), fresh({}, {});
  for (int i = 0; i < 5; ++i) law.follow(seen_at(1.1, 0.1 * i), {}, 0.03);
  law.restart();
  EXPECT_EQ(law.follow(seen_at(1.2, 0.1), {}, 0.03), fresh.follow(seen_at(1.2, 0.1), {}, 0.03));
}

TEST(PidLaw, SaysThatItIsNoNumberWhenTheMeasurementIsNone) {
  PidLaw law({}, {});
  EXPECT_FALSE(is_finite(law.follow(seen_at(std::nan(""), 0.0), {}, 0.1)));
}

TEST(Law, MayRememberNothing) {
  CountedLaw law;
  Bytes bytes;
  CheckpointWriter writer(bytes);
  static_cast<const Law&>(law).remember(writer);
  EXPECT_TRUE(bytes.empty());
}

TEST(Follower, OwnsTheLawThatDrives) {
  ASSERT_EQ(CountedLaw::alive, 0);
  {
    Follower follower(driven_by(counted_law("counted")));
    EXPECT_EQ(CountedLaw::alive, 1);
    Follower moved = std::move(follower);
    EXPECT_EQ(CountedLaw::alive, 1);
    moved = Follower(driven_by(counted_law("another")));
    EXPECT_EQ(CountedLaw::alive, 1);  // the first one is gone
  }
  EXPECT_EQ(CountedLaw::alive, 0);
}

TEST(Follower, LeavesNoLawBehindWhenItCannotBeMade) {
  FollowerConfig config = driven_by(counted_law("counted"));
  config.law = tests::even_controller();
  config.law.rules.consequents[0] = 99;  // seen after the law has been made
  EXPECT_THROW(Follower{config}, fuzzy::ValidationError);
  EXPECT_EQ(CountedLaw::alive, 0);
}

TEST(Follower, HandsOnWhatALawThrowsWhileItIsMade) {
  LawDescription law = counted_law("broken");
  law.make = [](const auto&, const auto&) -> std::unique_ptr<Law> { throw std::runtime_error("no licence"); };
  EXPECT_THROW(Follower{driven_by(law)}, std::runtime_error);
}

TEST(Follower, DoesNotDriveWithAnotherLawWhenItsOwnIsNotMade) {
  for (bool can_make : {false, true}) {
    FollowerConfig config = driven_by(counted_law("absent"));
    config.law = tests::even_controller();  // could drive instead, and nobody would know
    config.laws.back().make = nullptr;
    if (can_make) config.laws.back().make = [](const auto&, const auto&) { return std::unique_ptr<Law>(); };
    EXPECT_EQ(refused_key([&] { Follower{config}; }), "control.absent");
  }
}

TEST(Follower, ChecksTheParametersOfEveryLaw) {
  FollowerConfig config = driven_by(describe_law<OwnLaw, OwnConfig>("own", ""));
  config.active_law = "pid";
  config.laws.back().parameters[0].value = 9.0;  // past set_parameter()
  EXPECT_EQ(refused_key([&] { Follower{config}; }), "control.own.gain_per_s");
}

TEST(Follower, ListsTheLawsToWhoAsksForAnother) {
  FollowerConfig config = driven_by(counted_law("counted"));
  config.active_law = "magic";
  EXPECT_EQ(refused_key([&] { Follower{config}; }), "law");
  EXPECT_EQ(config.laws.back().name, law_names(config).back());
  EXPECT_EQ(law_names(config).front(), "fuzzy");
}

}  // namespace
