#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "pilotfish/api.hpp"
#include "pilotfish/control/leader_motion_estimator.hpp"
#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// How much a leader's own word counts.
struct LeaderIntentConfig {
  PILOTFISH_PARAMETERS(LeaderIntentConfig);
  PILOTFISH_PARAMETER(double, linear_tolerance_mps, 0.03, 0.001, 1.0,
                      "an announced speed so near to the seen one says the same");
  PILOTFISH_PARAMETER(double, angular_tolerance_radps, 0.15, 0.001, 5.0, "the same, of the turn rate");
  PILOTFISH_PARAMETER(double, max_age_s, 0.1, 0.0, 0.1, "older than the picture by more than this it says nothing");
  PILOTFISH_PARAMETER(double, confirmed_within_s, 0.15, 0.1, 0.5, "what is announced must be seen after so long");
  PILOTFISH_PARAMETER(double, probation_s, 0.5, 0.1, 60.0, "so long it must have agreed with vision before it counts");
  PILOTFISH_PARAMETER(double, suspended_s, 5.0, 1.0, 3600.0, "so long it does not count after one disagreement");
};

enum class LeaderIntentUse {
  silent,     ///< nothing announced, or too old
  probation,  ///< has not agreed with vision for long enough yet
  agrees,     ///< says what vision says: vision is used
  used,       ///< says that the leader is slowing down, which cannot be seen yet
  suspended,  ///< vision contradicted it
};
std::string_view to_string(LeaderIntentUse use) noexcept;

/// The twist a leader announces of itself, and what it is worth. Vision knows a steady leader's speed to millimetres
/// per second; all that a leader knows better is that it is about to change, which a picture shows one or two frames
/// late. So the word counts only
///
/// - after it has agreed with vision alone for probation_s: what was announced lately, give or take the tolerance and
///   three standard deviations of the estimate, holds what is seen;
/// - if it says that the leader is slower than vision still shows, by more than two tolerances: it can make the
///   robot slower, never faster, and never moves one that stands;
/// - while the leader drives away: to a leader that comes nearer, slow is not the safe side;
/// - for confirmed_within_s: if vision has not seen it by then, or when the leader says otherwise, it is suspended.
///
/// Nothing announced enters the estimate of vision, so that this stays the judge, and a lie leaves no trace in it.
class LeaderIntent {
 public:
  explicit LeaderIntent(const LeaderIntentConfig& config) : config_(config) {}  ///< nothing heard yet

  /// False, and nothing changes, unless it is finite, of this world and newer than the last.
  bool announce(std::int64_t utime, const Twist& twist) noexcept;

  bool heard() const { return !heard_.empty(); }  ///< anything has been announced

  /// Once a frame, with the leader as vision alone has it at that frame's time, seen from `own`.
  LeaderIntentUse evaluate(const LeaderEstimate& seen, const Pose2& own, std::int64_t utime) noexcept;

  /// If evaluate() has said `used`: when that holds from.
  std::int64_t since_utime() const { return newest().utime; }
  /// If evaluate() has said `used`: the estimate as slow as announced.
  LeaderEstimate slowed(const LeaderEstimate& seen) const noexcept;

  /// The leader was lost: probation begins anew, a suspension goes on.
  void reset() noexcept;

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.heard_, self.agreeing_since_, self.suspended_until_, self.claims_);
  }

 private:
  struct Announcement {
    Twist twist;
    std::int64_t utime = 0;
  };
  const Announcement& newest() const { return heard_.back(); }
  struct Axis {  // speed along the heading, or turn rate
    double Twist::*of;
    double seen, sigma, tolerance;
    double margin() const;
  };
  std::array<Axis, 2> axes(const LeaderEstimate& seen) const noexcept;
  bool holds(const Axis& axis, std::int64_t utime) const noexcept;
  bool says_slower(const Axis& axis) const noexcept;
  LeaderIntentUse suspend(std::int64_t utime) noexcept;

  LeaderIntentConfig config_;
  BoundedVector<Announcement, 64> heard_;  ///< by time; when full, the oldest is forgotten
  std::optional<std::int64_t> agreeing_since_, suspended_until_;
  std::array<std::optional<double>, 2> claims_;  ///< by axis: how slow the leader said it was, not yet seen
};

}  // namespace pilotfish::control
PILOTFISH_API_END
