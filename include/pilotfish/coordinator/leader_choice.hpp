#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// When another leader is followed than the preferred one.
struct LeaderChoiceConfig {
  static constexpr const char* kText =
      "Which robot is followed once the leader is lost; of no effect without `alternatives.leaders`.";
  PILOTFISH_PARAMETERS(LeaderChoiceConfig);
  /// Longer than safety.max_age_s can be: whatever was held for the leader before has become zero by then.
  PILOTFISH_PARAMETER(double, after_lost_s, 1.0, 0.3, 3600.0,
                      "the followed leader has not been seen for this time: the first other one in the list that is "
                      "seen reliably is followed");
  PILOTFISH_PARAMETER(double, back_after_s, 0.0, 0.0, 3600.0,
                      "the first leader has been seen for this time without a gap: it is followed again, although the "
                      "present one is in view; 0: never, else at least after_lost_s");
};

/// The preferred leader and seven others.
inline constexpr std::size_t kMaxLeaders = 8;

/// Which of several leaders are in a picture, by their number; 0 is the preferred one.
using LeadersSeen = std::array<bool, kMaxLeaders>;

/// Decides which leader is followed, by who was seen and when. A value.
///
///   followed one unseen for after_lost_s --> the first other one, in the order of the list, that is seen reliably
///   preferred one seen for back_after_s, while another one is followed --> the preferred one
///
/// Seen reliably: in this frame, and in kFrames since a gap longer than max_gap_s. Each change takes after_lost_s
/// without the present leader, or back_after_s with the preferred one, so that leaders who come and go cannot make it
/// change more often than that. A leader that is seen and not in the list does not exist here.
class LeaderChoice {
 public:
  static constexpr int kFrames = 5;  ///< that a leader must be seen in before it is followed

  /// max_gap_s: between two frames in which a leader is seen, so that it still counts as seen all the time.
  /// Throws ConfigError, below the section `alternatives`.
  LeaderChoice(const LeaderChoiceConfig& config, std::size_t leaders, double max_gap_s);

  /// Once per frame, utime [us] increasing: of the followed leader whether it was measured, of the others whether they
  /// could be followed. True: another one is followed from this frame on.
  bool update(std::int64_t utime, const LeadersSeen& seen) noexcept;

  std::size_t followed() const { return followed_; }  ///< its number
  std::int64_t changes() const { return changes_; }   ///< since the start
  /// Whether the followed one has been unseen for after_lost_s, as of the last frame.
  bool is_lost() const { return lost_; }

  /// Times begin anew with the next frame: another clock, or the robot was told to stand. The leader stays.
  void restart() noexcept;

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.followed_, self.changes_, self.utime_, self.seen_utime_, self.lost_, self.streaks_);
    if constexpr (Archive::kReads)
      if (self.followed_ >= self.leaders_) archive.fail();
  }

 private:
  /// How long a leader has been seen without a gap.
  struct Streak {
    std::int64_t since_utime = 0, last_utime = 0, frames = 0;  ///< 0 frames: not seen
  };
  bool is_reliable(std::size_t leader) const noexcept;
  bool change_to(std::size_t leader) noexcept;

  double after_lost_us_, back_after_us_, max_gap_us_;
  std::uint64_t leaders_;
  std::uint64_t followed_ = 0;
  std::int64_t changes_ = 0;
  std::optional<std::int64_t> utime_, seen_utime_;  ///< of the last frame; of the last with the followed leader
  bool lost_ = false;
  std::array<Streak, kMaxLeaders> streaks_{};
};

}  // namespace pilotfish
PILOTFISH_API_END
