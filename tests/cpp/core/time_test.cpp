#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "pilotfish/core/number.hpp"
#include "pilotfish/core/session_guard.hpp"
#include "pilotfish/core/utime.hpp"

namespace {

using namespace pilotfish;

constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();

// An image's stamp is no time of this host.
static_assert(!std::is_convertible_v<MonotonicTime, std::int64_t>);
static_assert(!std::is_convertible_v<std::int64_t, MonotonicTime>);
static_assert(noexcept(monotonic_now()) && noexcept(seconds_between(0, 0)) && noexcept(later(0, 0)));
static_assert(noexcept(std::declval<SequenceGuard&>().accept(0, 0)));

TEST(MonotonicTime, IsOrderedFromTheFirstInstantToTheLast) {
  const MonotonicTime times[] = {{kFirst}, {-1}, {0}, {1}, {kLast}};
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      EXPECT_EQ(times[i] < times[j], i < j);
      EXPECT_EQ(times[i] <= times[j], i <= j);
      EXPECT_EQ(times[i] == times[j], i == j);
      EXPECT_EQ(times[i] != times[j], i != j);
    }
}

TEST(MonotonicTime, DoesNotRunBackward) {
  MonotonicTime before = monotonic_now();
  for (int i = 0; i < 1000; ++i) {
    const MonotonicTime now = monotonic_now();
    ASSERT_TRUE(before <= now);
    before = now;
  }
}

TEST(SecondsBetween, CountsFromTheFirstInstantToTheLast) {
  // 2^64 - 1 microseconds do not fit into an int64, and 2^64 us = 1.8446744073709552e13 s.
  EXPECT_DOUBLE_EQ(seconds_between(kFirst, kLast), 1.8446744073709552e13);
  EXPECT_DOUBLE_EQ(seconds_between(kLast, kFirst), -1.8446744073709552e13);
  EXPECT_EQ(seconds_between(kLast, kLast), 0.0);
}

TEST(SecondsBetween, KnowsOneMicrosecondOfTheYear2255) {
  const std::int64_t utime = 9'000'000'000'000'000;  // 9e15 us = 285 years after 1970, below 2^53 = 9.007e15
  EXPECT_DOUBLE_EQ(seconds_between(utime, utime + 1), 1e-6);
}

TEST(Later, StandsStillAtTheEndOfTime) {
  EXPECT_EQ(later(kLast, 1), kLast);
  EXPECT_EQ(later(kLast - 1, 1), kLast);
  EXPECT_EQ(later(kLast - 1, kLast), kLast);
  EXPECT_EQ(later(kFirst, kLast), -1);
  EXPECT_EQ(later(kLast, 0), kLast);
  EXPECT_EQ(later_s(kLast - 5, 1.0), kLast);
}

TEST(WrapAngle, HasOneNameForTheWayBack) {
  EXPECT_EQ(wrap_angle(kPi), kPi);
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_TRUE(std::isnan(wrap_angle(std::nan(""))));
  EXPECT_TRUE(std::isnan(wrap_angle(std::numeric_limits<double>::infinity())));
}

TEST(NumberFrom, TakesTheWholeTextOrNothing) {
  EXPECT_EQ(number_from<int>("+5"), 5);
  EXPECT_EQ(number_from<int>("-5"), -5);
  for (const char* text : {"", "+", "-", "+-5", "++5", " 5", "5 ", "640abc", "0x10", "2147483648"})
    EXPECT_FALSE(number_from<int>(text).has_value()) << text;
  EXPECT_EQ(number_from<std::int64_t>("-9223372036854775808"), kFirst);
  EXPECT_FALSE(number_from<std::int64_t>("9223372036854775808").has_value());
}

TEST(NumberFrom, ReadsNoByteBehindTheText) {
  const char digits[] = {'1', '2', '3'};  // no zero behind them
  EXPECT_EQ(number_from<int>({digits, 2}), 12);
}

TEST(SequenceGuard, IsAtItsEndWithTheLargestCounter) {
  SequenceGuard guard(7);
  EXPECT_EQ(guard.accept(7, kLast), SequenceVerdict::accepted);
  EXPECT_EQ(guard.accept(7, kLast), SequenceVerdict::not_rising);
  EXPECT_EQ(guard.accept(7, kFirst), SequenceVerdict::not_rising);  // nothing wraps around
  EXPECT_EQ(guard.last_counter(), kLast);
}

TEST(SequenceGuard, AcceptsNothingWithoutASession) {
  SequenceGuard guard;
  EXPECT_EQ(guard.accept(0, 1), SequenceVerdict::wrong_session);
  EXPECT_EQ(guard.last_counter(), 0);
}

TEST(SetpointGate, KeepsWhatItKeptWhenItRefuses) {
  SetpointGate gate(7, 0.4);
  Setpoint kept, asked;
  kept.distance_m = 1.5;
  asked.bearing_rad = std::nan("");
  const SetpointDecision decision = gate.decide(7, 1, asked, kept);
  EXPECT_EQ(decision.verdict, SetpointVerdict::out_of_bounds);
  EXPECT_EQ(decision.setpoint.distance_m, 1.5);
  EXPECT_EQ(decision.setpoint.bearing_rad, 0.0);
  EXPECT_EQ(gate.last_counter(), 0);  // the counter can still be used
}

}  // namespace
