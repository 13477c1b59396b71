#include "pilotfish/coordinator/held_command.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <type_traits>

#include "memory_asked_for.hpp"
#include "pilotfish/core/checkpoint.hpp"

namespace {

using namespace pilotfish;

// A value that a thread of its own may copy, ask and throw away.
static_assert(std::is_trivially_copyable_v<HeldCommand> && std::is_trivially_copyable_v<HeldAnswer>);
static_assert(noexcept(std::declval<const HeldCommand&>().at(MonotonicTime{}, Reason::none)));
static_assert(noexcept(std::declval<const HeldCommand&>().fresh_at(MonotonicTime{})));

constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();

HeldCommand held_from_to(std::int64_t from_us, std::int64_t until_us) {
  HeldCommand held;
  held.command = {0.3, -0.5};
  held.from = {from_us};
  held.until = {until_us};
  held.holding = held.ever_measured = true;
  return held;
}

TEST(HeldCommand, IsZeroUntilSomethingIsHeld) {
  const HeldAnswer answer = HeldCommand{}.at({0}, Reason::no_frame);
  EXPECT_EQ(answer.command, Twist{});
  EXPECT_EQ(answer.status, Status::searching);
}

TEST(HeldCommand, HoldsFromItsFirstMicrosecondToItsLast) {
  const HeldCommand held = held_from_to(1000, 101'000);
  for (std::int64_t now : {1000, 50'000, 101'000}) {
    const HeldAnswer answer = held.at({now}, Reason::no_frame);
    EXPECT_EQ(answer.command, held.command) << now;
    EXPECT_EQ(answer.status, Status::coasting);
  }
}

TEST(HeldCommand, IsZeroOneMicrosecondAfterItsDeadline) {
  const HeldAnswer answer = held_from_to(1000, 101'000).at({101'001}, Reason::no_frame);
  EXPECT_EQ(answer.command, Twist{});
  EXPECT_EQ(answer.status, Status::lost);
  EXPECT_EQ(answer.reason, Reason::no_frame);
}

TEST(HeldCommand, IsZeroOneMicrosecondBeforeItsMeasurement) {
  EXPECT_EQ(held_from_to(1000, 101'000).at({999}, Reason::no_frame).command, Twist{});
}

TEST(HeldCommand, IsZeroWhenItsTimeWasOverBeforeItBegan) {
  EXPECT_EQ(held_from_to(1000, 999).at({1000}, Reason::none).command, Twist{});
  EXPECT_EQ(held_from_to(1000, 999).at({999}, Reason::none).command, Twist{});
}

TEST(HeldCommand, HoldsToTheEndOfTimeAndNoWayAround) {
  const HeldCommand held = held_from_to(kLast - 1, kLast);
  EXPECT_EQ(held.at({kLast}, Reason::none).command, held.command);
  EXPECT_EQ(held.at({kFirst}, Reason::none).command, Twist{});
}

TEST(HeldCommand, StandsStillWhenItIsToldToWhateverElseHolds) {
  HeldCommand held = held_from_to(0, 100);
  held.run = false;
  for (Reason reason : {Reason::none, Reason::frame_truncated}) {
    const HeldAnswer answer = held.at({50}, reason);
    EXPECT_EQ(answer.command, Twist{});
    EXPECT_EQ(answer.status, Status::stopped);
    EXPECT_EQ(answer.reason, Reason::stop_requested);
  }
}

TEST(HeldCommand, GivesABadPictureNoOtherLifeThanNone) {
  const HeldCommand held = held_from_to(0, 100);
  EXPECT_EQ(held.at({100}, Reason::frame_truncated).command, held.command);
  EXPECT_EQ(held.at({101}, Reason::frame_truncated).command, Twist{});
  EXPECT_EQ(held.at({101}, Reason::frame_truncated).status, Status::invalid_input);
}

TEST(HeldCommand, AsksForNoMemory) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  const HeldCommand held = held_from_to(0, 100);
  EXPECT_EQ(tests::memory_asked_for([&] {
              for (std::int64_t now = -50; now < 200; ++now) {
                const HeldCommand copy = held;
                if (copy.at({now}, Reason::no_frame).command.linear_mps > 0.3) throw 0;
              }
            }),
            0);
}

TEST(HeldCommand, GoesThroughACheckpoint) {
  Bytes bytes;
  CheckpointWriter writer(bytes);
  writer(held_from_to(kFirst, kLast));
  HeldCommand back;
  CheckpointReader reader(bytes);
  reader(back);
  EXPECT_TRUE(reader.read_all());
  EXPECT_EQ(back.from.us, kFirst);
  EXPECT_EQ(back.until.us, kLast);
  EXPECT_EQ(back.command, (Twist{0.3, -0.5}));
  EXPECT_TRUE(back.holding && back.run && back.ever_measured);
}

}  // namespace
