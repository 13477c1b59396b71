#include "pilotfish/coordinator/coordinator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "even_controller.hpp"
#include "memory_asked_for.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;

static_assert(noexcept(std::declval<Coordinator&>().step(std::declval<const Frame&>(), MonotonicTime{})));
static_assert(noexcept(std::declval<Coordinator&>().step_observation(0, vision::ObservationResult{}, MonotonicTime{})));
static_assert(noexcept(std::declval<const Coordinator&>().command_at(MonotonicTime{})));
static_assert(noexcept(std::declval<Coordinator&>().set_setpoint(Setpoint{})));
static_assert(noexcept(std::declval<Coordinator&>().set_ego_motion(0, Twist{})));
static_assert(noexcept(std::declval<Coordinator&>().set_leader_intent(0, Twist{})));
static_assert(std::is_nothrow_move_constructible_v<Coordinator>);
static_assert(!std::is_copy_constructible_v<Coordinator>);  // the vision have no copy
static_assert(!std::is_convertible_v<CoordinatorConfig, Coordinator>);
// A watchdog that has a const one can change nothing through what it gets.
static_assert(std::is_same_v<decltype(std::declval<const Coordinator&>().held()), const HeldCommand&>);
static_assert(std::is_same_v<decltype(std::declval<const Coordinator&>().setpoint()), const Setpoint&>);

constexpr std::int64_t kPeriod_us = 33'333;
constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();

CoordinatorConfig config() {
  CoordinatorConfig config;
  config.camera = {640, 480, 600.0, 600.0, 319.5, 239.5};
  config.leader.tags.push_back({});
  config.control.law = tests::even_controller();
  config.control.profile = control::Profile::paper;
  return config;
}

/// The leader, 1.2 m away: 0.2 m too far.
vision::ObservationResult leader_seen(std::int64_t utime, double distance_m = 1.2) {
  vision::ObservationResult sight;
  sight.observation.emplace();
  sight.observation->utime = utime;
  sight.observation->distance_m = distance_m;
  return sight;
}

/// Frames as they come, `count` of them; the stamps are the arrivals.
void drive(Coordinator& coordinator, std::int64_t first, int count) {
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t utime = first + i * kPeriod_us;
    coordinator.step_observation(utime, leader_seen(utime), {utime});
  }
}

class NotANumber final : public control::Law {
 public:
  Twist follow(const Observation&, const Setpoint&, double) noexcept override { return {std::nan(""), 0.0}; }
};

TEST(Coordinator, DrivesForMaxAgeAndNotAMicrosecondLonger) {
  Coordinator coordinator(config());
  drive(coordinator, 0, 1);  // 100 ms, both ends inclusive
  EXPECT_GT(coordinator.command_at({100'000}).command.linear_mps, 0.0);
  EXPECT_EQ(coordinator.command_at({100'001}).command, Twist{});
  EXPECT_EQ(coordinator.command_at({100'001}).status, Status::lost);
}

TEST(Coordinator, IsAskedForACommandWithoutBeingChanged) {
  Coordinator asked(config()), twin(config());
  drive(asked, 0, 3);
  drive(twin, 0, 3);
  for (std::int64_t now = 0; now < 1'000'000; now += 1000) asked.command_at({now}, Reason::camera_frozen);
  EXPECT_EQ(asked.memory().decisions, twin.memory().decisions);
}

std::int64_t ticking_ns() noexcept {
  static std::int64_t now_ns = 0;
  return now_ns += 1000;
}

TEST(Coordinator, TimesItsVisionOnlyWithAClockThatItIsGiven) {
  Coordinator coordinator(config());
  const auto look = [&](std::int64_t utime) {
    const auto gray = static_cast<std::uint8_t>(utime == 0 ? 128 : 129);  // a picture twice would not be looked at
    coordinator.step(Frame::from_pixels(utime, 640, 480, std::vector<std::uint8_t>(640 * 480, gray)), {utime});
    return coordinator.stages().ns(vision::Stage::detect);
  };
  EXPECT_EQ(look(0), 0);
  coordinator.time_stages(ticking_ns);
  EXPECT_EQ(look(kPeriod_us), 1000);  // one look at the clock a stage; nothing is followed, so there is a detection
}

TEST(Coordinator, AsksForNoMemoryWhenItIsAskedForACommand) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  Coordinator coordinator(config());
  drive(coordinator, 0, 3);
  const auto asked = tests::memory_asked_for([&] {
    for (std::int64_t now = 0; now < 300'000; now += 100)
      if (coordinator.command_at({now}).command.linear_mps > 1.0) throw 0;
  });
  EXPECT_EQ(asked, 0);
}

TEST(Coordinator, AsksForNoMemoryWhenItAnswersASight) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  Coordinator coordinator(config());
  drive(coordinator, 0, 3);
  Setpoint setpoint;
  const auto asked = tests::memory_asked_for([&] {
    drive(coordinator, 3 * kPeriod_us, 30);
    for (bool run : {false, true}) {
      setpoint.run = run;
      coordinator.set_setpoint(setpoint);
      drive(coordinator, (run ? 63 : 33) * kPeriod_us, 30);
    }
  });
  EXPECT_EQ(asked, 0);
}

TEST(Coordinator, GoesOnWithTheSameBitsAfterAMove) {
  Coordinator coordinator(config()), twin(config());
  drive(coordinator, 0, 5);
  drive(twin, 0, 5);
  Coordinator moved = std::move(coordinator);
  drive(moved, 5 * kPeriod_us, 5);
  drive(twin, 5 * kPeriod_us, 5);
  EXPECT_EQ(moved.memory().decisions, twin.memory().decisions);
  EXPECT_EQ(moved.memory().vision, twin.memory().vision);
}

TEST(Coordinator, TakesNoMemoryThatIsCutShortAndChangesNothing) {
  Coordinator source(config()), coordinator(config());
  drive(source, 0, 5);
  drive(coordinator, 1'000'000, 2);
  const CoordinatorMemory before = coordinator.memory(), whole = source.memory();
  for (std::size_t size = 0; size < whole.decisions.size(); size += 3) {
    CoordinatorMemory cut = whole;
    cut.decisions.resize(size);
    ASSERT_FALSE(coordinator.set_memory(cut)) << size;
    ASSERT_EQ(coordinator.memory().decisions, before.decisions) << size;
    ASSERT_EQ(coordinator.memory().vision, before.vision) << size;
  }
  CoordinatorMemory blind = whole;
  blind.vision.pop_back();
  EXPECT_FALSE(coordinator.set_memory(blind));
  EXPECT_EQ(coordinator.memory().decisions, before.decisions);
  EXPECT_TRUE(coordinator.set_memory(whole));
  EXPECT_EQ(coordinator.memory().decisions, whole.decisions);
}

TEST(Coordinator, StandsStillWhenALawIsNoNumber) {
  CoordinatorConfig own = config();
  own.control.laws.push_back({"nan", "", {}, [](const auto&, const auto&) { return std::make_unique<NotANumber>(); }});
  own.control.active_law = "nan";
  Coordinator coordinator(own);
  const StepResult result = coordinator.step_observation(0, leader_seen(0), {0});
  EXPECT_EQ(result.reason, Reason::law_not_finite);
  EXPECT_EQ(result.command, Twist{});
  EXPECT_TRUE(result.observation.has_value());  // so that a recording has it
}

TEST(Coordinator, StandsStillWhenTheMeasurementIsNoNumber) {
  Coordinator coordinator(config());
  drive(coordinator, 0, 3);
  const StepResult result = coordinator.step_observation(100'000, leader_seen(100'000, std::nan("")), {100'000});
  EXPECT_EQ(result.reason, Reason::law_not_finite);
  EXPECT_EQ(coordinator.command_at({100'000}).command, Twist{});
}

TEST(Coordinator, HoldsACommandAtTheEndOfTheClock) {
  // 100 ms after the last instant is no instant: the deadline must not wrap around, nor be undefined.
  Coordinator coordinator(config());
  coordinator.step_observation(kLast, leader_seen(kLast), {kLast});
  EXPECT_EQ(coordinator.held().until.us, kLast);
  EXPECT_EQ(coordinator.command_at({kLast}).status, Status::coasting);
}

TEST(Coordinator, BearsStampsFromOneEndOfTimeToTheOther) {
  Coordinator coordinator(config());
  const std::int64_t stamps[] = {0, std::numeric_limits<std::int64_t>::min(), kLast, -1, kLast - 1, 1};
  std::int64_t now = 0;
  for (int round = 0; round < 8; ++round)
    for (std::int64_t utime : stamps)
      EXPECT_TRUE(
          is_finite(coordinator.step_observation(utime, leader_seen(utime), {now += kPeriod_us}, utime).command));
}

TEST(Coordinator, KeepsItsSetpointWhenItRefusesAnother) {
  Coordinator coordinator(config());
  Setpoint near, aside;
  near.distance_m = std::nextafter(0.4, 0.0);  // the stop distance
  aside.bearing_rad = std::nextafter(kMaxBearing_rad, 2.0);
  for (Setpoint setpoint : {near, aside}) {
    EXPECT_FALSE(coordinator.set_setpoint(setpoint));
    setpoint.run = false;  // a stop is always taken, and nothing else of it
    EXPECT_TRUE(coordinator.set_setpoint(setpoint));
    EXPECT_FALSE(coordinator.setpoint().run);
    EXPECT_EQ(coordinator.setpoint().distance_m, 1.0);
    EXPECT_EQ(coordinator.setpoint().bearing_rad, 0.0);
  }
}

TEST(Coordinator, IsNotMadeOfWhatCannotWork) {
  const auto refused_key = [](const CoordinatorConfig& given) {
    return tests::refused_key([&] { Coordinator{given}; });
  };
  EXPECT_EQ(refused_key(config()), "nothing");
  CoordinatorConfig wrong = config();
  wrong.setpoint.distance_m = 0.3;
  EXPECT_EQ(refused_key(wrong), "setpoint.distance_m");
  wrong = config();
  wrong.safety.max_age_s = 0.2;  // 0.12 m of blind travel at 0.6 m/s
  EXPECT_EQ(refused_key(wrong), "safety.max_age_s");
  wrong = config();
  wrong.mounting.pan_rad = 3.0;  // it looks back
  EXPECT_EQ(refused_key(wrong), "camera.mounting.pan_deg");
  wrong = config();
  wrong.camera.fx = std::nan("");
  EXPECT_EQ(refused_key(wrong), "camera.fx");
}

TEST(FrozenCamera, IsCertainOfTheSamePixelsTheThirdTime) {
  std::vector<std::uint8_t> pixels(64 * 64, 100);
  pixels[5] = 3;
  const Frame frame = Frame::from_pixels(0, 64, 64, pixels);
  FrozenCamera camera;
  EXPECT_EQ(camera.compare(frame.image), Repetition::none);
  EXPECT_EQ(camera.compare(frame.image), Repetition::probable);
  EXPECT_EQ(camera.compare(frame.image), Repetition::certain);
  pixels[63 * 64 + 63] ^= 1U;  // one gray level of one pixel is a sensor's noise
  EXPECT_EQ(camera.compare(Frame::from_pixels(1, 64, 64, pixels).image), Repetition::none);
}

}  // namespace
