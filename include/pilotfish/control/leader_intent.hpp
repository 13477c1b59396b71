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

/// How the leader intent is used.
struct LeaderIntentConfig {
  PILOTFISH_PARAMETERS(LeaderIntentConfig);
  PILOTFISH_PARAMETER(double, linear_tolerance_mps, 0.03, 0.001, 1.0,
                      "an announced speed this near to the estimated one agrees with it");
  PILOTFISH_PARAMETER(double, angular_tolerance_radps, 0.15, 0.001, 5.0, "the same, of the turn rate");
  PILOTFISH_PARAMETER(double, max_age_s, 0.1, 0.0, 0.1,
                      "an intent older than the picture by more than this is not used");
  PILOTFISH_PARAMETER(double, confirmed_within_s, 0.15, 0.1, 0.5, "vision must confirm a used intent within this time");
  PILOTFISH_PARAMETER(double, probation_s, 0.5, 0.1, 60.0,
                      "the intent must have agreed with vision for this time before use");
  PILOTFISH_PARAMETER(double, suspended_s, 5.0, 1.0, 3600.0,
                      "the intent is not used for this time after one disagreement");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, feed_forward, false,
                                    "announced changes of a moving leader's speed are fed forward, also upwards; for "
                                    "chains whose robots announce what they are about to drive");
  PILOTFISH_PARAMETER(double, feed_forward_limit_mps, 0.1, 0.0, 1.0,
                      "with feed_forward: by this at most the leader is taken to be faster than vision predicts");
  PILOTFISH_PARAMETER(double, bias_time_s, 2.0, 0.1, 60.0,
                      "with feed_forward: time constant with which the announced speed is corrected to the seen one");
};

enum class LeaderIntentUse {
  silent,     ///< nothing announced, or too old
  probation,  ///< has not agreed with vision for long enough yet
  agrees,     ///< agrees with vision: vision is used
  used,       ///< the leader is slowing down, which vision cannot measure yet
  suspended,  ///< vision contradicted it
};
std::string_view to_string(LeaderIntentUse use) noexcept;

/// The twist a leader announces of itself, and whether to use it. Vision measures a steady leader's speed to
/// millimetres per second; the intent adds only the coming change of that speed, which a picture shows one or two
/// frames late. So it is used only
///
/// - after it has agreed with vision alone for probation_s: the estimate is within the range of the recent intents,
///   widened by the tolerance and three standard deviations of the estimate;
/// - if it is slower than the estimate of vision by more than two tolerances: it can make the
///   robot slower, never faster, and never moves a standing one;
/// - while the leader drives away: if it approaches, assuming a lower speed is not safe;
/// - for confirmed_within_s: if vision has not confirmed it by then, or the intent is withdrawn, it is suspended.
///
/// With feed_forward also a leader that becomes faster is believed, within feed_forward_limit_mps of what vision
/// predicts; agreement, confirmation and suspension are the same, and a leader that stands is not moved. What bounds
/// the robot's speed, the guard, takes nothing from it.
///
/// No intent enters the estimate of vision, which stays an independent reference that a false intent cannot affect.
class LeaderIntent {
 public:
  explicit LeaderIntent(const LeaderIntentConfig& config) : config_(config) {}  ///< nothing received yet

  /// False, and nothing changes, unless it is finite, plausible and newer than the last.
  bool update(std::int64_t utime, const Twist& twist) noexcept;

  bool has_intent() const { return !received_.empty(); }  ///< an intent has been received

  /// Once a frame, with vision's own estimate of the leader at that frame's time, relative to `own`.
  LeaderIntentUse evaluate(const LeaderEstimate& seen, const Pose2& own, std::int64_t utime) noexcept;

  /// If evaluate() returned `used`: the time from which it holds.
  std::int64_t since_utime() const { return newest().utime; }
  /// If evaluate() returned `used` with feed_forward: the estimate predicted for `utime`, `ahead_s` after the picture,
  /// with the speed that is announced for then.
  LeaderEstimate fed_forward(const LeaderEstimate& predicted, std::int64_t utime, double ahead_s) const noexcept;
  /// If evaluate() returned `used` without: the estimate, slowed down to the intent.
  LeaderEstimate slowed(const LeaderEstimate& seen) const noexcept;

  /// The leader was lost: probation begins anew, a suspension goes on.
  void reset() noexcept;

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.received_, self.agreeing_since_, self.suspended_until_, self.claims_, self.bias_mps_,
            self.bias_utime_);
  }

 private:
  struct Announcement {
    Twist twist;
    std::int64_t utime = 0;
  };
  const Announcement& newest() const { return received_.back(); }
  struct Axis {  // speed along the heading, or turn rate
    double Twist::*of;
    double seen, sigma, tolerance;
    double margin() const;
  };
  std::array<Axis, 2> axes(const LeaderEstimate& seen) const noexcept;
  bool holds(const Axis& axis, std::int64_t utime) const noexcept;
  bool announces_slower(const Axis& axis) const noexcept;
  double announced_mps(std::int64_t utime) const noexcept;
  void learn_bias(double seen_mps, std::int64_t utime) noexcept;
  LeaderIntentUse suspend(std::int64_t utime) noexcept;

  LeaderIntentConfig config_;
  BoundedVector<Announcement, 64> received_;  ///< by time; when full, the oldest is dropped
  std::optional<std::int64_t> agreeing_since_, suspended_until_;
  std::array<std::optional<double>, 2> claims_;  ///< by axis: the slower speed announced, not yet confirmed
  std::optional<double> bias_mps_;               ///< seen less announced speed, low-passed
  std::int64_t bias_utime_ = 0;                  ///< of the last picture it was learned from
};

}  // namespace pilotfish::control
PILOTFISH_API_END
