#include "pilotfish/blackbox/black_box.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <thread>
#include <type_traits>
#include <vector>

#include "even_controller.hpp"
#include "refused_key.hpp"
#include "scratch_folder.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::blackbox;
using tests::refused_key;
using tests::ScratchFolder;

static_assert(!std::is_copy_constructible_v<BlackBox> && !std::is_move_constructible_v<BlackBox>);
static_assert(noexcept(std::declval<BlackBox&>().frame({}, {}, {}, std::declval<const Coordinator&>())));
static_assert(noexcept(std::declval<BlackBox&>().setpoint({}, true, std::declval<const Coordinator&>())));
static_assert(noexcept(std::declval<BlackBox&>().ego_motion(0, {}, true, std::declval<const Coordinator&>())));
static_assert(noexcept(std::declval<BlackBox&>().leader_intent(0, {}, true, std::declval<const Coordinator&>())));
static_assert(noexcept(std::declval<BlackBox&>().sent({}, {}, Reason::none, {}, 0, 0)));
static_assert(noexcept(std::declval<BlackBox&>().message("", nullptr, 0)));
static_assert(noexcept(std::declval<BlackBox&>().picture({})));
static_assert(noexcept(std::declval<const BlackBox&>().counters()));

constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();

CoordinatorConfig coordinator_config() {
  CoordinatorConfig config;
  config.camera = {64, 48, 60.0, 60.0, 31.5, 23.5};
  config.leader.tags.push_back({});
  config.control.law = tests::validated_controller();
  return config;
}

config::BlackBoxConfig config_in(const ScratchFolder& folder) {
  config::BlackBoxConfig config;
  config.directory = folder.path().string();
  config.total_mb = 100;
  config.segment_mb = 10;
  config.picture_rate_hz = 1000.0;
  return config;
}

Start start() {
  Start start;
  start.robot = "robot1";
  return start;
}

/// What is on the disk once the box is gone.
std::string recorded(const ScratchFolder& folder) {
  std::string bytes;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    std::ifstream file(entry.path(), std::ios::binary);
    bytes.append(std::istreambuf_iterator<char>(file), {});
  }
  return bytes;
}

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
  return count;
}

class BlackBoxTest : public ::testing::Test {
 protected:
  const ScratchFolder folder;
  const Coordinator core{coordinator_config()};
};

TEST_F(BlackBoxTest, HasWrittenAllThatItTookWhenItIsGone) {
  {
    BlackBox box(config_in(folder), start(), core);
    for (int i = 0; i < 100; ++i) box.message("ROBOT1_SETPOINT", "12345678", 8);
    EXPECT_EQ(box.counters().dropped, 0);
  }
  EXPECT_EQ(times(recorded(folder), "ROBOT1_SETPOINT12345678"), 100U);
}

TEST_F(BlackBoxTest, KeepsNothingOfWhatItWasHanded) {
  {
    BlackBox box(config_in(folder), start(), core);
    for (int i = 0; i < 50; ++i) {
      auto channel = std::make_unique<std::string>("ROBOT1_NOTE");
      std::vector<char> data(1000, 'a');
      box.message(*channel, data.data(), data.size());
      channel->assign(channel->size(), 'x');
      data.assign(data.size(), 'x');
    }
  }
  EXPECT_EQ(times(recorded(folder), "ROBOT1_NOTE" + std::string(1000, 'a')), 50U);
}

TEST_F(BlackBoxTest, KeepsAPictureWhosePixelsTheCallerTakesBack) {
  {
    BlackBox box(config_in(folder), start(), core);
    std::vector<std::uint8_t> pixels(64 * 48, 90);
    Frame borrowed;
    borrowed.image = {pixels.data(), pixels.size(), 64, 48, 64};
    box.picture(borrowed);
    pixels.clear();
    pixels.shrink_to_fit();  // AddressSanitizer would see who reads them still
  }
  EXPECT_EQ(times(recorded(folder), "ROBOT1_IMAGE"), 1U);
}

TEST_F(BlackBoxTest, CopiesOfABorrowedPictureNoMoreThanItShows) {
  // A corner of 64 x 48 pixels of 48 MB: with all that may be read behind it, it would not fit into the queue.
  std::vector<std::uint8_t> large(std::size_t{48} << 20, 90);
  {
    BlackBox box(config_in(folder), start(), core);
    Frame corner;
    corner.image = {large.data(), large.size(), 64, 48, 8192};
    box.picture(corner);
    EXPECT_EQ(box.counters().dropped, 0);
  }
  EXPECT_EQ(times(recorded(folder), "ROBOT1_IMAGE"), 1U);
}

TEST_F(BlackBoxTest, MakesNothingOfAPictureThatIsNone) {
  {
    BlackBox box(config_in(folder), start(), core);
    Frame lies;
    lies.image = {nullptr, std::numeric_limits<std::size_t>::max(), 64, 48, 64};
    box.picture(lies);
    box.picture({});
  }
  EXPECT_EQ(times(recorded(folder), "ROBOT1_IMAGE"), 0U);
}

TEST_F(BlackBoxTest, DropsAndCountsWhatDoesNotFitIntoItsQueue) {
  BlackBox box(config_in(folder), start(), core);
  const std::vector<char> large(std::size_t{25} << 20, 'a');  // of 32 MB three quarters are for messages
  box.message("ROBOT1_NOTE", large.data(), large.size());
  EXPECT_EQ(box.counters().dropped, 1);
  box.message(std::string(large.begin(), large.end()), nullptr, 0);  // a channel takes memory as well
  EXPECT_EQ(box.counters().dropped, 2);
}

TEST_F(BlackBoxTest, TakesEveryStampAndNumberThereIs) {
  BlackBox box(config_in(folder), start(), core);
  const double infinity = std::numeric_limits<double>::infinity();
  for (std::int64_t end : {kFirst, std::int64_t{0}, kLast}) {
    Frame frame;
    frame.utime = frame.known_age_us = end;
    box.frame(frame, {end}, {}, core);
    box.ego_motion(end, {infinity, -infinity}, false, core);
    box.leader_intent(end, {std::numeric_limits<double>::quiet_NaN(), 0.0}, false, core);
    box.sent(core.held(), {end}, Reason::none, {}, end, end);
  }
  EXPECT_EQ(box.counters().dropped, 0);
}

TEST_F(BlackBoxTest, TakesMessagesFromEveryThreadAtOnce) {
  {
    BlackBox box(config_in(folder), start(), core);
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&box] {
        for (int k = 0; k < 250; ++k) box.message("ROBOT1_NOTE", "abcd", 4);
      });
    for (std::thread& thread : threads) thread.join();
  }
  EXPECT_EQ(times(recorded(folder), "ROBOT1_NOTEabcd"), 1000U);
}

TEST_F(BlackBoxTest, OutlivesTheCoordinatorItWasMadeWith) {
  auto short_lived = std::make_unique<Coordinator>(coordinator_config());
  BlackBox box(config_in(folder), start(), *short_lived);
  short_lived.reset();
  box.message("ROBOT1_NOTE", "abcd", 4);
  EXPECT_EQ(box.counters().dropped, 0);
}

TEST_F(BlackBoxTest, IsNotMadeWhereNothingCanBeWritten) {
  config::BlackBoxConfig config = config_in(folder);
  config.directory.clear();
  EXPECT_EQ(refused_key([&] { BlackBox(config, start(), core); }), "black_box.directory");
  config.directory = folder.write("file", "").string();
  EXPECT_EQ(refused_key([&] { BlackBox(config, start(), core); }), "black_box.directory");
  config = config_in(folder);
  config.segment_mb = 0;
  EXPECT_EQ(refused_key([&] { BlackBox(config, start(), core); }), "black_box.segment_mb");
  config = config_in(folder);
  Start nameless = start();
  nameless.robot = "";
  EXPECT_EQ(refused_key([&] { BlackBox(config, nameless, core); }), "name");
}

TEST_F(BlackBoxTest, LetsGoOfItsPlaceWhenItIsGoneOrWasNeverMade) {
  config::BlackBoxConfig config = config_in(folder);
  {
    BlackBox box(config, start(), core);
    EXPECT_EQ(refused_key([&] { BlackBox(config, start(), core); }), "black_box.directory");  // one at a time
  }
  EXPECT_NO_THROW(BlackBox(config, start(), core));
}

TEST_F(BlackBoxTest, KeepsPicturesAsRarelyAsItIsAsked) {
  config::BlackBoxConfig config = config_in(folder);
  // 1e6 / 1e-300 us is no int64: "never", not a time that has long passed.
  config.picture_rate_hz = 1e-300;
  {
    BlackBox box(config, start(), core);
    box.picture(Frame::from_pixels(1, 64, 48, std::vector<std::uint8_t>(64 * 48, 90)));
  }
  EXPECT_EQ(times(recorded(folder), "ROBOT1_IMAGE"), 0U);
}

}  // namespace
