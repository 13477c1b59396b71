#include "pilotfish/coordinator/leader_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "pilotfish/core/checkpoint.hpp"
#include "refused_key.hpp"

namespace {

using namespace pilotfish;

constexpr std::int64_t kPeriod_us = 40'000;  // 25 Hz, so that a second is a whole number of frames
constexpr double kMaxGap_s = 0.1;

LeaderChoice choice(double after_lost_s, double back_after_s, std::size_t leaders = 3) {
  return {{after_lost_s, back_after_s}, leaders, kMaxGap_s};
}

/// A camera at 25 Hz; counts how often a leader was changed.
class Play {
 public:
  explicit Play(LeaderChoice choice) : choice_(choice) {}

  void frames(int count, bool first, bool second, bool third = false) {
    for (int i = 0; i < count; ++i) {
      LeadersSeen seen{first, second, third};
      utime_ += kPeriod_us;
      if (!choice_.update(utime_, seen)) continue;
      if (changes_++ > 0) least_gap_us_ = std::min(least_gap_us_, utime_ - changed_utime_);
      changed_utime_ = utime_;
    }
  }
  LeaderChoice& choice() { return choice_; }
  int changes() const { return changes_; }
  std::int64_t least_gap_us() const { return least_gap_us_; }

 private:
  LeaderChoice choice_;
  std::int64_t utime_ = 1'000'000;
  std::int64_t changed_utime_ = 0, least_gap_us_ = std::numeric_limits<std::int64_t>::max();
  int changes_ = 0;
};

TEST(LeaderChoice, KeepsTheLeaderThatIsSeenWhoeverElseIsInView) {
  Play play(choice(0.4, 0.4));
  play.frames(1000, true, true, true);
  EXPECT_EQ(play.choice().followed(), 0u);
  EXPECT_EQ(play.changes(), 0);
}

TEST(LeaderChoice, TakesAnotherOneOnceTheLeaderIsUnseenForTheWholeTime) {
  Play play(choice(1.0, 0.0));
  play.frames(1, true, true);
  play.frames(24, false, true);  // 0.96 s after the last sight
  EXPECT_EQ(play.choice().followed(), 0u);
  play.frames(1, false, true);  // 1.00 s
  EXPECT_EQ(play.choice().followed(), 1u);
  EXPECT_EQ(play.choice().changes(), 1);
}

TEST(LeaderChoice, TakesTheFirstOfTheListThatIsSeen) {
  Play both(choice(0.4, 0.0)), second_only(choice(0.4, 0.0));
  both.frames(1, true, true, true);
  both.frames(10, false, true, true);
  EXPECT_EQ(both.choice().followed(), 1u);
  second_only.frames(1, true, false, true);
  second_only.frames(10, false, false, true);
  EXPECT_EQ(second_only.choice().followed(), 2u);
}

TEST(LeaderChoice, TakesNobodyWhoWasSeenInFewerFramesThanFive) {
  Play play(choice(0.4, 0.0));
  play.frames(1, true, false);
  play.frames(50, false, false);
  play.frames(LeaderChoice::kFrames - 1, false, true);
  EXPECT_EQ(play.choice().followed(), 0u);
  EXPECT_TRUE(play.choice().is_lost());
  play.frames(3, false, false);  // a gap of 160 ms: what was seen before counts no more
  play.frames(LeaderChoice::kFrames - 1, false, true);
  EXPECT_EQ(play.choice().followed(), 0u);
  play.frames(1, false, true);
  EXPECT_EQ(play.choice().followed(), 1u);
}

TEST(LeaderChoice, TakesNobodyWhoIsNotInThisVeryFrame) {
  Play play(choice(0.4, 0.0));
  play.frames(1, true, true);
  play.frames(9, false, true);   // reliable, at 0.36 s
  play.frames(1, false, false);  // at 0.4 s
  EXPECT_EQ(play.choice().followed(), 0u);
}

TEST(LeaderChoice, ReturnsToTheFirstOneOnlyAfterItWasSeenWithoutAGap) {
  Play play(choice(0.4, 1.0));
  play.frames(1, true, true);
  play.frames(10, false, true);
  ASSERT_EQ(play.choice().followed(), 1u);
  play.frames(20, true, true);
  play.frames(3, false, true);
  play.frames(25, true, true);  // 0.96 s since its first frame
  EXPECT_EQ(play.choice().followed(), 1u);
  play.frames(1, true, true);
  EXPECT_EQ(play.choice().followed(), 0u);
}

TEST(LeaderChoice, NeverReturnsWhereItIsToldNotTo) {
  Play play(choice(0.4, 0.0));
  play.frames(1, true, true);
  play.frames(10, false, true);
  play.frames(10'000, true, true);
  EXPECT_EQ(play.choice().followed(), 1u);
}

TEST(LeaderChoice, ReturnsWhenItsNewLeaderIsLostTooIfNothingElseIsSeen) {
  Play play(choice(0.4, 0.0));
  play.frames(1, true, true);
  play.frames(10, false, true);
  play.frames(9, true, false);
  EXPECT_EQ(play.choice().followed(), 1u);
  play.frames(1, true, false);
  EXPECT_EQ(play.choice().followed(), 0u);
}

// Visible every other second: unseen for less than after_lost_s, or seen for less than back_after_s.
TEST(LeaderChoice, DoesNotFlapWithALeaderThatBlinks) {
  Play patient(choice(1.1, 1.1)), quick(choice(0.5, 1.1));
  for (int i = 0; i < 100; ++i) {
    for (Play* play : {&patient, &quick}) {
      play->frames(25, true, true);
      play->frames(25, false, true);
    }
  }
  EXPECT_EQ(patient.changes(), 0);
  EXPECT_EQ(quick.changes(), 1);
}

// However they come and go: two changes are at least after_lost_s apart, because back_after_s is not shorter.
TEST(LeaderChoice, ChangesNoMoreOftenThanTheRuleAllows) {
  Play play(choice(0.4, 0.4));
  std::uint32_t random = 1;
  for (int i = 0; i < 2000; ++i) {
    random = random * 1664525u + 1013904223u;
    play.frames(1 + static_cast<int>(random >> 28), (random >> 20 & 1) != 0, (random >> 21 & 1) != 0,
                (random >> 22 & 1) != 0);
  }
  EXPECT_GT(play.changes(), 10);
  EXPECT_GE(play.least_gap_us(), 400'000);
}

TEST(LeaderChoice, CountsFromTheStartAgainAfterARestart) {
  Play play(choice(1.0, 0.0));
  play.frames(1, true, true);
  play.frames(20, false, true);
  play.choice().restart();
  play.frames(25, false, true);
  EXPECT_EQ(play.choice().followed(), 0u);
  play.frames(1, false, true);
  EXPECT_EQ(play.choice().followed(), 1u);
}

TEST(LeaderChoice, GoesOnFromWhatItRemembers) {
  Play play(choice(1.0, 2.0));
  play.frames(1, true, true);
  play.frames(17, false, true);
  Bytes bytes, again;
  CheckpointWriter{bytes}(play.choice());
  LeaderChoice restored = choice(1.0, 2.0);
  CheckpointReader reader(bytes);
  reader(restored);
  ASSERT_TRUE(reader.read_all());
  CheckpointWriter{again}(restored);
  EXPECT_EQ(bytes, again);
}

TEST(LeaderChoice, RemembersNoLeaderThatThereIsNot) {
  Play play(choice(0.4, 0.0));
  play.frames(1, true, false, true);
  play.frames(10, false, false, true);
  Bytes bytes;
  CheckpointWriter{bytes}(play.choice());
  LeaderChoice of_two = choice(0.4, 0.0, 2);
  CheckpointReader reader(bytes);
  reader(of_two);
  EXPECT_FALSE(reader.read_all());
}

TEST(LeaderChoice, IsNotMadeOfWhatWouldFlap) {
  const auto made = [](double lost, double back, std::size_t leaders = 2) {
    return [=] { choice(lost, back, leaders); };
  };
  EXPECT_EQ(tests::refused_key(made(0.29, 0.0)), "alternatives.after_lost_s");
  EXPECT_EQ(tests::refused_key(made(2.0, 1.9)), "alternatives.back_after_s");
  EXPECT_EQ(tests::refused_key(made(2.0, -1.0)), "alternatives.back_after_s");
  EXPECT_EQ(tests::refused_key(made(1.0, 1.0, kMaxLeaders + 1)), "alternatives.leaders");
}

}  // namespace
