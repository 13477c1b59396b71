#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "memory_asked_for.hpp"
#include "pilotfish/base/command_guard.hpp"
#include "pilotfish/base/serial_protocol.hpp"
#include "pilotfish/base/stop_latch.hpp"
#include "pilotfish/base/wheel_limits.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::base;

static_assert(noexcept(std::declval<CommandGuard&>().receive({}, {}, {})));
static_assert(noexcept(std::declval<CommandGuard&>().command_at({})));
static_assert(noexcept(std::declval<StopLatch&>().receive({}, 0)));
static_assert(noexcept(limit(WheelLimitsConfig{}, DriveGeometry{}, Twist{}, Twist{}, 0.0)));
static_assert(noexcept(std::declval<ControllerParser&>().feed('$')));
static_assert(!std::is_convertible_v<bool, StopLatch>);

constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr MonotonicTime kValidUntil{1'100'000};  // 100 ms after the instant at which most tests begin

ReceivedCommand command(std::int64_t counter) { return {5, counter, 9, kValidUntil, {0.3, 0.1}, false}; }
CommandGuard guard() { return CommandGuard({}, 9, false); }

TEST(CommandGuard, ObeysACommandForItsLifeAndNotAMicrosecondLonger) {
  CommandGuard wheels = guard();
  EXPECT_EQ(wheels.receive(command(1), {1'000'000}, {1'000'000}), CommandVerdict::accepted);
  for (std::int64_t now = 1'000'000; now < 1'095'000; now += 1000) EXPECT_TRUE(wheels.command_at({now}).has_value());
  EXPECT_TRUE(wheels.command_at({1'094'999}).has_value());
  EXPECT_FALSE(wheels.command_at({1'095'000}).has_value());  // 95 ms
}

TEST(CommandGuard, TakesNoCommandThatHasWaitedForItsWholeLife) {
  CommandGuard late = guard(), in_time = guard();
  EXPECT_EQ(late.receive(command(1), {1'000'000}, {1'095'000}), CommandVerdict::stale);
  EXPECT_EQ(in_time.receive(command(1), {1'000'000}, {1'094'999}), CommandVerdict::accepted);
}

TEST(CommandGuard, EndsACommandWithItsMeasurement) {
  // The measurement was 70 ms old when the command left: 30 ms are left, whatever its own life.
  CommandGuard wheels = guard();
  ReceivedCommand aged = command(1);
  aged.valid_until = {1'030'000};
  EXPECT_EQ(wheels.receive(aged, {1'000'000}, {1'000'000}), CommandVerdict::accepted);
  EXPECT_EQ(*wheels.deadline(), MonotonicTime{1'030'000});
  EXPECT_TRUE(wheels.command_at({1'029'999}).has_value());
  EXPECT_FALSE(wheels.command_at({1'030'000}).has_value());
}

TEST(CommandGuard, TakesNoCommandWhoseMeasurementIsTooOld) {
  // Held up between the check of its age and its leaving: it has only just arrived.
  for (const std::int64_t valid_until : {kFirst, std::int64_t{0}, std::int64_t{999'999}, std::int64_t{1'000'000}}) {
    CommandGuard wheels = guard();
    ReceivedCommand late = command(1);
    late.valid_until = {valid_until};
    EXPECT_EQ(wheels.receive(late, {1'000'000}, {1'000'000}), CommandVerdict::expired) << valid_until;
    EXPECT_FALSE(wheels.command_at({1'000'000}).has_value());
  }
}

TEST(CommandGuard, TakesNoCommandThatClaimsALongerValidityThanAnyMeasurementHas) {
  // safety.max_age_s is at most 0.25 s: a sender that states more has another clock, and states nothing.
  for (const std::int64_t valid_until : {1'000'001 + CommandGuard::kLongestValidity_us, kLast}) {
    CommandGuard wheels = guard();
    ReceivedCommand wrong = command(1);
    wrong.valid_until = {valid_until};
    EXPECT_EQ(wheels.receive(wrong, {1'000'000}, {1'000'000}), CommandVerdict::malformed) << valid_until;
  }
}

TEST(CommandGuard, TakesZerosWhateverTheirValidity) {
  for (const std::int64_t valid_until : {kFirst, std::int64_t{0}, kLast}) {
    CommandGuard wheels = guard();
    wheels.receive(command(1), {1'000'000}, {1'000'000});
    EXPECT_EQ(wheels.receive({5, 2, 9, {valid_until}, {}, false}, {1'010'000}, {1'010'000}), CommandVerdict::accepted);
    EXPECT_EQ(*wheels.command_at({1'010'000}), Twist{});
  }
}

TEST(CommandGuard, TakesNoCommandFromTheBeginningOfTime) {
  // now - arrived is 2^63 us and more, which is no int64: it must not look like a command of the future.
  CommandGuard wheels = guard();
  EXPECT_EQ(wheels.receive(command(1), {kFirst}, {1'000'000}), CommandVerdict::stale);
  EXPECT_FALSE(wheels.command_at({1'000'000}).has_value());
}

TEST(CommandGuard, IsAtItsEndWithTheLargestCounter) {
  CommandGuard wheels = guard();
  EXPECT_EQ(wheels.receive(command(kLast), {1'000'000}, {1'000'000}), CommandVerdict::accepted);
  EXPECT_EQ(wheels.receive(command(kLast), {1'000'001}, {1'000'001}), CommandVerdict::replayed);
  EXPECT_EQ(wheels.receive(command(kFirst), {1'000'002}, {1'000'002}), CommandVerdict::replayed);
}

TEST(CommandGuard, ObeysNoNewSenderWhenItCanRememberNoMore) {
  CommandGuard wheels = guard();
  ReceivedCommand stranger = command(1);
  for (std::size_t i = 0; i < CommandGuard::kSessions; ++i) {
    stranger.session = 100 + static_cast<std::int64_t>(i);
    wheels.receive(stranger, {1'000'000}, {1'000'000});
  }
  stranger.session = 5;
  EXPECT_EQ(wheels.receive(stranger, {1'000'001}, {1'000'001}), CommandVerdict::sessions_full);
  stranger.session = 100;  // the first one is obeyed as before
  stranger.counter = 2;
  EXPECT_EQ(wheels.receive(stranger, {1'000'002}, {1'000'002}), CommandVerdict::accepted);
}

TEST(CommandGuard, AsksForNoMemory) {
  PILOTFISH_NEEDS_ALLOCATION_COUNTER();
  CommandGuard wheels = guard();
  EXPECT_EQ(tests::memory_asked_for([&] {
              for (std::int64_t i = 1; i < 2000; ++i) {
                ReceivedCommand each = command(i);
                each.session = 1 + i % 1500;
                wheels.receive(each, {i * 1000}, {i * 1000});
                wheels.command_at({i * 1000});
              }
            }),
            0);
}

TEST(StopLatch, IsEndedByAHigherCounterOfTheObeyedSessionOnly) {
  StopLatch latch;
  EXPECT_EQ(latch.receive({0, 0, false}, 5), LatchVerdict::stopped);  // anyone stops
  EXPECT_EQ(latch.receive({5, 1, true}, 0), LatchVerdict::other_session);
  EXPECT_EQ(latch.receive({0, 1, true}, 0), LatchVerdict::other_session);  // 0 is no session
  EXPECT_EQ(latch.receive({5, kLast, false}, 5), LatchVerdict::stopped);   // uses its number up
  EXPECT_EQ(latch.receive({5, kLast, true}, 5), LatchVerdict::replayed);
  EXPECT_TRUE(latch.stopped());
  EXPECT_EQ(latch.receive({6, 1, true}, 6), LatchVerdict::resumed);
  EXPECT_FALSE(latch.stopped());
}

TEST(WheelLimits, MakeAZeroOfWhatIsNoNumber) {
  const double values[] = {std::nan(""), kInfinity, -kInfinity, 1e308, -1e308, 0.0, 0.3};
  for (double linear : values)
    for (double angular : values)
      for (double dt_s : values) {
        const Twist limited = limit({}, {}, {linear, angular}, {0.1, 0.1}, dt_s);
        ASSERT_TRUE(is_finite(limited)) << linear << " " << angular << " " << dt_s;
        ASSERT_LE(std::abs(limited.linear_mps), 0.7);
        ASSERT_LE(std::abs(limited.angular_radps), 2.5);
        if (!std::isfinite(linear) && !std::isfinite(angular)) {
          EXPECT_EQ(limited, Twist{});
        }
      }
}

TEST(Crc8, IsThePolynomialsCheckValue) {
  // Catalogue of parametrised CRC algorithms, CRC-8/SMBUS (0x07, start 0): check value of "123456789" is F4.
  EXPECT_EQ(crc8("123456789"), 0xF4);
  EXPECT_EQ(crc8(""), 0);
}

TEST(SetPointLine, SendsAZeroForWhatIsNoNumber) {
  const std::string zero(SetPointLine(7, {0.0, 0.0}).text());
  EXPECT_EQ(zero.rfind("$PFW,7,0,0*", 0), 0U) << zero;
  EXPECT_EQ(SetPointLine(7, {std::nan(""), std::nan("")}).text(), zero);
  EXPECT_EQ(SetPointLine(7, {kInfinity, -kInfinity}).text(), zero);
}

TEST(SetPointLine, IsNeverLongerThanALine) {
  for (double speed : {1e308, -1e308, 1e3, -1e3})
    EXPECT_LE(SetPointLine(65535, {speed, -speed}).text().size(), kMaxLine + 2) << speed;  // and its end
}

TEST(ControllerParser, HearsALineAfterAnyNoiseAndAsksForNoMemory) {
  // A hundred times the same byte of noise, then a good line.
  const std::string body = "PFE,3,1000,-5,6,0";
  char end[8];
  std::snprintf(end, sizeof end, "*%02X\r\n", crc8(body));
  const std::string line = "$" + body + end;
  ControllerParser parser;
  int lines = 0;
  const std::int64_t asked = tests::memory_asked_for([&] {
    for (int noise = 0; noise < 256; ++noise) {
      for (int i = 0; i < 100; ++i) parser.feed(static_cast<char>(noise));
      for (char byte : line)
        if (const auto received = parser.feed(byte))
          lines += received->encoders.left_ticks == -5 && received->sequence == 3;
    }
  });
  EXPECT_EQ(lines, 256);
  if (probes::can_count_allocations()) {
    EXPECT_EQ(asked, 0);
  }
}

TEST(ControllerParser, TakesNoLineCutShort) {
  const std::string body = "PFE,3,1000,-5,6,0";
  char end[8];
  std::snprintf(end, sizeof end, "*%02X\r\n", crc8(body));
  const std::string line = "$" + body + end;
  for (std::size_t size = 0; size + 4 < line.size(); ++size) {
    ControllerParser parser;
    for (char byte : line.substr(0, size) + "\r\n") EXPECT_FALSE(parser.feed(byte).has_value()) << size;
  }
}

}  // namespace
