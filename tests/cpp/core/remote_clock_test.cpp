#include "pilotfish/core/remote_clock.hpp"

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace pilotfish;

TEST(RemoteClock, KnowsNothingBeforeTheFirstMessage) { EXPECT_FALSE(RemoteClock{}.convert({1'000'000}).has_value()); }

TEST(RemoteClock, TakesTheQuickestMessageForTheDifference) {
  RemoteClock clock;  // 5 s ahead of ours; the messages travel for 30, 2 and 10 ms
  clock.received(6'000'000, {1'030'000});
  EXPECT_EQ(*clock.convert({1'030'000}), 6'000'000);  // 30 ms before the truth
  clock.received(6'100'000, {1'102'000});
  clock.received(6'110'000, {1'120'000});
  // 2 ms before it, and 10 us more for the 10 ms by which this lies after that message
  EXPECT_EQ(*clock.convert({1'112'000}), 6'110'000 - 10);
}

TEST(RemoteClock, ForgetsTheQuickestAsTheClocksMayDriftApart) {
  RemoteClock clock;
  clock.received(1'000'000, {1'000'000});    // no time on its way
  clock.received(11'000'000, {11'009'000});  // 9 ms: worse than the first, lowered by 1 % of 10 s = 10 ms
  EXPECT_EQ(*clock.convert({11'009'000}), 11'000'000);
}

TEST(RemoteClock, ForgetsAForgedMessage) {
  RemoteClock clock;
  clock.received(9'000'000'000, {1'000'000});  // some hours ahead
  for (std::size_t i = 0; i < RemoteClock::kMessages; ++i) clock.received(2'000'000, {2'000'000});
  EXPECT_EQ(*clock.convert({2'000'000}), 2'000'000);
}

TEST(RemoteClock, IsNeverLateWhateverTheDelaysAndTheDrift) {
  // The other clock gains or loses 600 ppm, the most that a quartz and NTP do together; messages take 0 to 200 ms.
  std::mt19937 random(4);
  std::uniform_int_distribution<std::int64_t> delay_us(0, 200'000), pause_us(1'000, 500'000);
  for (const double rate : {1.0 - 600e-6, 1.0, 1.0 + 600e-6}) {
    RemoteClock clock;
    const auto truth = [&](std::int64_t own_us) {
      return static_cast<std::int64_t>(3e6 + rate * static_cast<double>(own_us));
    };
    std::int64_t now_us = 0;
    for (int i = 0; i < 20'000; ++i) {
      now_us += pause_us(random);
      clock.received(truth(now_us), {now_us + delay_us(random)});
      const std::int64_t asked_us = now_us + 300'000;
      ASSERT_LE(*clock.convert({asked_us}), truth(asked_us) + 1) << "rate " << rate << " after " << i;
      ASSERT_GE(*clock.convert({asked_us}), truth(asked_us) - 202'000);
    }
  }
}

}  // namespace
