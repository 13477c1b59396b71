#pragma once

#include <cstdint>
#include <optional>

#include "pilotfish/control/follower.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/vision/leader_observer.hpp"

namespace pilotfish {

struct SafetyConfig {
  double max_age_s = 0.1;  ///< a measurement older than this moves nothing: then v = w = 0
  static const std::vector<Parameter<SafetyConfig>>& parameters();
};

/// Everything a coordinator needs to know; see data/config/coordinator.yaml.
struct CoordinatorConfig {
  CameraModel camera;
  CameraMounting mounting;
  LeaderBody leader;
  vision::LeaderObserverConfig vision;
  control::FollowerConfig control;
  SafetyConfig safety;
  Setpoint setpoint;
};

/// What one frame led to: status and reason, the measurement, the law's inner life, the command.
struct StepResult {
  std::int64_t utime = 0;  ///< exposure of the frame this answers [us]
  Status status = Status::searching;
  Reason reason = Reason::none;
  std::optional<Observation> observation;          ///< only when measured in this very frame
  std::optional<control::FollowerOutput> control;  ///< only when the law ran in this very frame
  Twist command;                                   ///< what the wheels should do now
};

/// The heart, on one screen:
///
///     Frame --> vision::LeaderObserver --> Observation --> control::Follower --> Twist
///                        |
///                        +--> no observation: hold the last command for max_age_s, then zero
///
/// Pure and deterministic: no clock, no I/O, no randomness. All time is the frames' own exposure time, so the robot,
/// the simulator, a replay and pytest run the same code and get the same bits. step() never throws.
///
///   searching --measured--> tracking --not measured--> coasting --older than max_age_s--> lost --measured--> tracking
///   any --setpoint.run = false--> stopped;  a frame that cannot be used is "not measured" too, as invalid_input
class Coordinator {
 public:
  /// Throws ConfigError naming the parameter.
  explicit Coordinator(const CoordinatorConfig& config);

  StepResult step(const Frame& frame) noexcept;

  /// step() without the eyes: `sight` is what the observer made of the frame exposed at `utime`. For simulations that
  /// draw measurements instead of pictures; everything behind the observer is the same.
  StepResult answer(std::int64_t utime, const vision::Sight& sight) noexcept;

  /// What holds at `utime` (on the frames' clock) if no newer frame has come: the last command for as long as it is
  /// fresh, then zeros. Changes nothing, so a watchdog may ask as often as it likes without disturbing determinism.
  /// `reason` says what was missing: no frame at all, or only one that was too old on arrival.
  StepResult without_frame(std::int64_t utime, Reason reason = Reason::no_frame) const noexcept;

  /// False, and the old one stays, if a number is out of range or not finite.
  bool set_setpoint(const Setpoint& setpoint) noexcept;
  const Setpoint& setpoint() const { return setpoint_; }

  /// Optional, at any rate, between frames: the own twist as odometry measured it, and the twist the leader announces
  /// of itself. utime is on the frames' clock. False, and nothing changes, if it cannot be used: not finite, too fast,
  /// not newer than the last, more than kOtherClock_s away from the last frame, or no frame yet. Neither moves the
  /// robot; see control::OwnMotion and control::AnnouncedMotion.
  bool set_own_motion(std::int64_t utime, const Twist& twist) noexcept;
  bool set_announced_motion(std::int64_t utime, const Twist& twist) noexcept;
  static constexpr double kOtherClock_s = 1.0;
  const vision::RejectionCounters& rejected() const { return observer_.rejected(); }

 private:
  bool fresh_at(std::int64_t utime) const noexcept;
  bool is_near_last_frame(std::int64_t utime) const noexcept;
  StepResult answer_latest(std::int64_t utime, const vision::Sight& sight) noexcept;
  StepResult not_measured(std::int64_t utime, Reason reason) const noexcept;
  bool is_newer(std::int64_t utime) noexcept;    ///< if so, it is the latest; rests if nothing is fresh any more
  void rest(std::int64_t since_utime) noexcept;  ///< the wheels stand still from then on: forget the motion so far

  std::int64_t max_age_us_ = 0;
  vision::LeaderObserver observer_;
  control::Follower follower_;
  Setpoint setpoint_;
  std::optional<std::int64_t> last_frame_utime_;
  std::optional<std::int64_t> last_measured_utime_;  ///< empty while the wheels rest
  bool ever_measured_ = false;
  Twist last_command_;  ///< of the last measured frame
};

}  // namespace pilotfish
