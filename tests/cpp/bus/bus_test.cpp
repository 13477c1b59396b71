#include "pilotfish/bus/bus.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <type_traits>

#include "pilotfish/bus/log_reader.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::bus;

// Handlers and subscriptions point into a Bus, so it stays where it is; so does what owns a socket or a file.
static_assert(!std::is_copy_constructible_v<Bus> && !std::is_move_constructible_v<Bus>);
static_assert(!std::is_move_assignable_v<Bus> && !std::is_move_constructible_v<FinalMessage>);
static_assert(!std::is_move_constructible_v<LogReader>);
static_assert(!std::is_convertible_v<std::string, Bus>);
static_assert(noexcept(std::declval<const FinalMessage&>().send()));  // called by a signal handler
static_assert(std::is_base_of_v<std::runtime_error, BusError>);

std::ptrdiff_t open_files() {
  const std::filesystem::directory_iterator first("/proc/self/fd");
  return std::distance(first, std::filesystem::directory_iterator());
}

SetpointReport stop(std::int64_t counter) {
  SetpointReport report;
  report.counter = counter;
  report.setpoint.run = false;
  return report;
}

CommandReport command(std::int64_t counter) {
  CommandReport report;
  report.session = 5;
  report.counter = counter;
  return report;
}

TEST(Bus, HandsOnWhatAHandlerThrowsAndKeepsTheMessagesBehind) {
  Bus bus("memq://");
  std::vector<std::int64_t> received;
  bus.on_command("robot1", [&](const CommandReport& report) {
    received.push_back(report.counter);
    if (report.counter == 1) throw std::domain_error("from a handler");
  });
  for (std::int64_t counter : {1, 2, 3}) bus.publish("robot1", command(counter));
  EXPECT_THROW(bus.handle(1000), std::domain_error);
  EXPECT_EQ(received, std::vector<std::int64_t>{1});
  while (bus.handle(100) > 0) {
  }
  EXPECT_EQ(received, (std::vector<std::int64_t>{1, 2, 3}));
}

TEST(Bus, CannotBeHandledFromItsOwnHandler) {
  Bus bus("memq://");
  bus.on_command("robot1", [&](const CommandReport&) { bus.handle(0); });
  bus.publish("robot1", command(1));
  EXPECT_THROW(bus.handle(1000), std::logic_error);
  bus.publish("robot1", command(2));  // and is no longer being handled after that
  EXPECT_THROW(bus.handle(1000), std::logic_error);
}

TEST(Bus, PublishesNoNumberThatIsNone) {
  Bus bus("memq://");
  std::optional<CommandReport> received;
  bus.on_command("robot1", [&](const CommandReport& report) { received = report; });
  CommandReport report = command(1);
  report.command = {std::nan(""), 0.5};
  bus.publish("robot1", report);
  bus.handle(1000);
  ASSERT_TRUE(received.has_value());
  EXPECT_EQ(received->command, Twist{});  // both are zero: half a command is none
  EXPECT_EQ(bus.rejected().size(), 1U);
}

TEST(Bus, AcceptsAStopOfAnotherKeyAndNoNumberInIt) {
  Bus bus("memq://");
  std::vector<SetpointReport> received;
  bus.on_setpoint("robot1", [&](const SetpointReport& report) { received.push_back(report); });
  bus.set_key(Key({1}));
  bus.publish("robot1", stop(7));  // encoded now, with this key; checked when it is handled, with the other one
  bus.set_key(Key({2}));
  bus.handle(1000);
  bus.publish("robot1", stop(8));
  bus.handle(1000);
  ASSERT_EQ(received.size(), 2U);
  EXPECT_FALSE(received[0].setpoint.run);
  EXPECT_EQ(received[0].counter, 0);
  EXPECT_EQ(received[1].counter, 8);
}

TEST(Bus, AddsUpMoreThanAnInt64OfWhatDoesNotFit) {
  Bus bus("memq://");
  std::optional<StatusReport> received;
  bus.on_status("robot1", [&](const StatusReport& report) { received = report; });
  StatusReport report;
  const std::int64_t half = std::int64_t{1} << 62;  // two of them are 2^63
  for (int i = 100; i < 300; ++i) report.rejected["a_reason_to_refuse_" + std::to_string(i)] = half;
  bus.publish("robot1", report);
  bus.handle(1000);
  ASSERT_TRUE(received.has_value());
  EXPECT_EQ(received->rejected.at("others"), std::numeric_limits<std::int64_t>::max());
}

TEST(Bus, ShowsWhatItPublishedToItsTap) {
  Bus bus("memq://");
  std::vector<std::string> channels;
  std::size_t bytes = 0;
  bus.on_published([&](const std::string& channel, const std::vector<std::uint8_t>& message) {
    channels.push_back(channel);
    bytes += message.size();
  });
  bus.publish("robot1", command(1));
  bus.publish("robot1", stop(1));
  EXPECT_EQ(channels, (std::vector<std::string>{"ROBOT1_COMMAND", "ROBOT1_SETPOINT"}));
  EXPECT_GT(bytes, 0U);
}

TEST(Bus, LeavesNoFileOpenWhenItCannotBeOpened) {
  const auto before = open_files();
  for (const char* url : {"nothing://", "udpm://1.2.3.4:7667", "udpm://239.255.76.67:99999", "udpm://x:1"})
    EXPECT_ANY_THROW(Bus{url}) << url;
  EXPECT_EQ(open_files(), before);
}

TEST(Bus, ClosesWhatItOpened) {
  const auto before = open_files();
  for (int i = 0; i < 3; ++i) {
    Bus bus("memq://");
    bus.on_command("robot1", [](const CommandReport&) {});
    EXPECT_GE(open_files(), before);
  }
  EXPECT_EQ(open_files(), before);
}

TEST(Channel, IsOneWordOfUpTo63Letters) {
  EXPECT_EQ(channel("robot1", "COMMAND"), "ROBOT1_COMMAND");
  for (const std::string& robot : {std::string(".*"), std::string("a b"), std::string(60, 'a')})
    EXPECT_THROW(channel(robot, "COMMAND"), ConfigError) << robot;
}

TEST(FinalMessage, SendsNothingWithoutANetwork) {
  const auto before = open_files();
  FinalMessage message("memq://", "ROBOT1_COMMAND", {1, 2, 3});
  message.send();
  EXPECT_EQ(open_files(), before);
}

TEST(FinalMessage, ClosesItsSocket) {
  const auto before = open_files();
  {
    FinalMessage message("udpm://239.255.76.67:7667?ttl=0", "ROBOT1_COMMAND", {1, 2, 3});
    EXPECT_EQ(open_files(), before + 1);
  }
  EXPECT_EQ(open_files(), before);
}

TEST(LogReader, LeavesNoFileOpenWhenThereIsNothingToRead) {
  const auto before = open_files();
  EXPECT_THROW(LogReader("/nowhere/at/all", "ROBOT1_IMAGE"), BusError);
  EXPECT_THROW(LogReader("/dev/null", "ROBOT1_IMAGE"), BusError);
  EXPECT_THROW(LogReader("/", "ROBOT1_IMAGE"), BusError);
  EXPECT_EQ(open_files(), before);
}

}  // namespace
