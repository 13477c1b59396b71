#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/control/follower.hpp"
#include "pilotfish/coordinator/frame_timeline.hpp"
#include "pilotfish/coordinator/frozen_camera.hpp"
#include "pilotfish/coordinator/held_command.hpp"
#include "pilotfish/coordinator/leader_choice.hpp"
#include "pilotfish/core/checkpoint.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/range_scan.hpp"
#include "pilotfish/core/refused_value.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/vision/leader_observer.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// The limits of safety.
struct SafetyConfig {
  PILOTFISH_PARAMETERS(SafetyConfig);
  PILOTFISH_PARAMETER(
      double, max_age_s, 0.1, 0.0, 0.25,
      "a measurement older than this moves nothing; above 0.1 only if max_age_s x the top speed stays within 0.06 m");
  /// There the two robots would touch.
  PILOTFISH_PARAMETER(
      double, stop_distance_m, 0.4, 0.0, 20.0,
      "no setpoint below this is accepted: between turning centres; half of each robot's length and a margin");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(
      bool, noiseless_camera, false,
      "true: pictures are synthetic, so that repeated identical pixels do not mean a frozen camera");
};

/// The age limit bounds blind travel: max_age_s times the top speed. Above 100 ms it is allowed only while
/// that product is at most that of 0.6 m/s and 100 ms.
inline constexpr double kOrdinaryMaxAge_s = 0.1;
inline constexpr double kMaxBlindTravel_m = 0.06;
/// Frames must come a little more often than measurements expire, or the robot would stop in between: 12 Hz at 100 ms.
inline constexpr double kMinFramesPerMaxAge = 1.2;

/// Another robot that may be followed while the leader is lost, and what is kept behind it.
struct AlternativeLeader {
  PILOTFISH_PARAMETERS(AlternativeLeader);
  PILOTFISH_PARAMETER(double, distance_m, 1.0, 0.05, 20.0, "distance to keep to this leader");
  PILOTFISH_PARAMETER(double, bearing_rad, 0.0, -kMaxBearing_rad, kMaxBearing_rad,
                      "observation angle to keep to this leader; positive: leader left");
  LeaderBody leader;  ///< its tags, of the first leader's family and with other ids than anybody else's here
};

/// A coordinator's configuration; see data/config/coordinator.yaml.
struct CoordinatorConfig {
  CameraModel camera;                   ///< size and lens of the coordinator's camera
  CameraMounting mounting;              ///< where it sits on the coordinator
  LeaderBody leader;                    ///< the tags to follow
  vision::LeaderObserverConfig vision;  ///< how the leader is seen
  control::FollowerConfig control;      ///< how it is followed
  SafetyConfig safety;                  ///< the limits of safety
  Setpoint setpoint;                    ///< what to keep at first
  LeaderChoiceConfig alternatives;      ///< when another leader is followed
  /// In the order in which they are tried; empty: the leader is the only one, and then nothing of this matters.
  std::vector<AlternativeLeader> other_leaders;

  template <class Visit>
  static void sections(Visit&& visit) {  ///< see core/sections.hpp; camera and leader are files of their own
    using C = CoordinatorConfig;
    visit("setpoint", &C::setpoint);
    visit("vision", &C::vision);
    visit("control", &C::control);
    visit("safety", &C::safety);
    visit("alternatives", &C::alternatives);
  }
};

/// The result of one frame: status and reason, the measurement, the law's intermediate results, the command.
struct StepResult {
  std::int64_t utime = 0;                          ///< exposure of the frame this answers [us]
  Status status = Status::searching;               ///< Status of the coordinator
  Reason reason = Reason::none;                    ///< Reason for the status
  std::optional<Observation> observation;          ///< only when measured in this very frame
  std::optional<control::FollowerOutput> control;  ///< only when the law ran in this very frame
  Twist command;                                   ///< for the wheels, now
  RefusedValue refused;                            ///< what goes with the reason, if a gate compared numbers
  std::int64_t leader_index = 0;                   ///< who is followed: 0 the leader, 1 the first alternative, ...
  std::int64_t leader_changes = 0;                 ///< how often that has changed since the start
};

/// In two parts, so that a replay of recorded observations can omit the second.
struct CoordinatorMemory {
  Bytes decisions;  ///< timeline, law, setpoint, held command
  Bytes vision;     ///< state of the observer and of the frozen-camera check
};

/// The coordinator:
///
///     Frame, arrival --> FrameTimeline: in order, fresh? --> FrozenCamera --> vision::LeaderObserver --> Observation
///                                                                                                           |
///     Twist <-- HeldCommand: until the measurement is max_age_s old, then zero <-- control::Follower <------+
///
/// Pure and deterministic: no clock, no I/O, no randomness. `now` is monotonic and given: the same frames at the same
/// times give the same bits, on the robot, in the simulator, in a replay and in pytest. step() never throws.
///
///   searching --measured--> tracking --not measured--> coasting --older than max_age_s--> lost --measured--> tracking
///   lost, with control.search: turns in place, while frames and ranges are fresh; nothing else moves without a leader
///   any --setpoint.run = false--> stopped;  a frame that cannot be used is "not measured" too, as invalid_input
///
/// With `alternatives`: lost for after_lost_s --> LeaderChoice takes another robot, once that is seen reliably and
/// where it can be followed. The follower then begins anew with it, its own setpoint, and the measurement of that very
/// frame; until then nothing moves. Each leader has an observer and a setpoint of its own.
///
/// A frame without a measurement cannot prolong the last one: HeldCommand is written when
/// the law has answered a measurement (or the search a frame without one), and cleared; nowhere else. Where
/// control.avoidance is enabled nothing is held for longer than the ranges are fresh.
class Coordinator {
 public:
  /// Throws ConfigError naming the parameter.
  explicit Coordinator(const CoordinatorConfig& config);

  /// now: when the frame arrived at this host, however long it waited for this call. Never before an earlier `now`; if
  /// it is, the earlier one holds.
  StepResult step(const Frame& frame, MonotonicTime now) noexcept;

  /// step() without the vision: `seen` is the observer's result for the frame exposed at `utime`. For simulations that
  /// draw measurements instead of pictures, and for replays of recorded ones; everything behind the observer is the
  /// same.
  StepResult step_observation(std::int64_t utime, const vision::ObservationResult& seen, MonotonicTime now,
                              std::int64_t known_age_us = 0) noexcept;
  /// The same with what was seen of each leader, by its number; `seen` of the followed one alone says that nobody else
  /// was in view. Those that are missing were not seen.
  StepResult step_observations(std::int64_t utime, const std::vector<vision::ObservationResult>& seen,
                               MonotonicTime now, std::int64_t known_age_us = 0) noexcept;

  /// The same from a recording: what was measured of the leader that is followed after this frame, and in_view() as it
  /// was then. With one leader that is step_observation().
  StepResult step_recorded(std::int64_t utime, const vision::ObservationResult& seen, const LeadersSeen& in_view,
                           MonotonicTime now, std::int64_t known_age_us = 0) noexcept;

  /// What holds at `now` if no newer frame has come: the last command for as long as it is fresh, then zeros. Changes
  /// nothing, so that a watchdog may call it at any time without affecting determinism. `reason` is what was
  /// missing.
  StepResult command_at(MonotonicTime now, Reason reason = Reason::no_frame) const noexcept;
  /// The same as a value, for a thread that sends commands.
  const HeldCommand& held() const { return held_; }

  /// What to keep behind the leader that is followed now; those of the others stay. False, and the old one stays, if a
  /// number is out of range, not finite, or below the stop distance. A stop is always accepted: then only `run` changes
  /// if the rest cannot be used.
  bool set_setpoint(const Setpoint& setpoint) noexcept;
  const Setpoint& setpoint() const { return setpoints_[leader_index()]; }  ///< what is kept

  std::size_t leader_index() const { return choice_.followed(); }    ///< who is followed; 0: the configured leader
  std::int64_t leader_changes() const { return choice_.changes(); }  ///< since the start
  /// In the last frame that was used: of the leader that was followed until then whether it was measured, of the others
  /// whether they could be followed.
  const LeadersSeen& in_view() const { return in_view_; }
  const LeaderBody& leader() const { return observer().tracker().body(); }  ///< who is followed

  /// Optional, at any rate, between frames: the own twist as odometry measured it, and the leader
  /// intent. utime is on the frames' clock. False, and nothing changes, if it cannot be used: not finite, too fast,
  /// not newer than the last, more than kOtherClock_s away from the last frame, or no frame yet. Neither moves the
  /// robot; see control::EgoMotion and control::LeaderIntent.
  bool set_ego_motion(std::int64_t utime, const Twist& twist) noexcept;
  /// The leader intent; see set_ego_motion(). The configured leader's, and false while another one is followed.
  bool set_leader_intent(std::int64_t utime, const Twist& twist) noexcept;
  /// Needed where control.avoidance is enabled, at any rate, between frames: what sonars or a laser measured, which
  /// arrived at `now`. False, and nothing changes, where that is off, and of a scan that cannot be used: see
  /// is_usable(); more than half a second from the last frame; not newer than the last. These checks by
  /// stamp do not prove that it is fresh: its arrival does.
  bool set_ranges(const RangeScan& scan, MonotonicTime now) noexcept;
  static constexpr double kOtherClock_s = 1.0;          ///< farther from the last frame is another clock
  vision::RejectionCounters rejected() const noexcept;  ///< by the observers, since the start; of all leaders together
  /// Tags that the followed leader does not wear, in the last whole picture that was searched; 8 at most.
  const std::vector<int>& foreign_ids() const { return observer().foreign_ids(); }
  std::int64_t whole_picture_searches() const noexcept;  ///< since the start
  /// Times the stages of the observers from the next frame on, with the caller's clock; nullptr: not any more.
  void time_stages(vision::StageStopwatch::Clock clock) noexcept;
  /// Of the last frame that was used, on the way to the leader that is followed.
  const vision::StageStopwatch& stages() const { return observer().stages(); }

  /// Its state, bit for bit, apart from its configuration: another one of the same configuration that is restored
  /// from this continues exactly as this one would. For recordings that are replayed from their middle; not a copy of
  /// the object, because the vision cannot be copied.
  CoordinatorMemory memory() const;
  /// False, and nothing changes, if that is no state of this program.
  bool set_memory(const CoordinatorMemory& memory);

  std::int64_t clock_epochs() const { return timeline_.epochs(); }  ///< how often the source's clock was set

 private:
  template <class Self, class Archive>
  static void remember_decisions(Self& self, Archive& archive);
  template <class Self, class Archive>
  static void remember_vision(Self& self, Archive& archive);
  bool ranges_fresh_at(MonotonicTime now) const noexcept;
  /// A turn in search of the leader, held like any command; nothing where there is none.
  std::optional<StepResult> search(std::int64_t utime, std::int64_t age_us, Reason reason) noexcept;
  /// Held from now on, for as long as frame and ranges are fresh.
  void hold(const Twist& command, std::int64_t age_us, bool turning) noexcept;
  bool is_near_last_frame(std::int64_t utime) const noexcept;
  const vision::LeaderObserver& observer() const { return observers_[leader_index()]; }
  void clear_seen() noexcept;
  /// Fills seen_.
  void observe(const Frame& frame) noexcept;
  void look_for_others(const Frame& frame) noexcept;
  void compare_leaders() noexcept;  ///< seen_ --> in_view_
  /// From in_view_: whether another leader is followed from this frame on.
  bool change_leader(std::int64_t utime) noexcept;
  bool can_follow(const vision::ObservationResult& seen) const noexcept;
  bool another_is_seen() const noexcept;
  StepResult with_leader(StepResult result) const noexcept;
  StepResult step_latest(std::int64_t utime, std::int64_t age_us) noexcept;
  StepResult not_measured(std::int64_t utime, Reason reason) const noexcept;
  StampVerdict classify(std::int64_t utime, std::int64_t known_age_us, MonotonicTime now) noexcept;
  void stop_now() noexcept;  ///< the command is zero from now on, the estimate goes on
  void pause() noexcept;  ///< the last measurement has expired: the command has been zero since, the estimate goes on
  void rest(std::int64_t since_utime) noexcept;  ///< the wheels stand still from then on: resets the motion
  void begin_epoch() noexcept;                   ///< earlier measurements and motion are unrelated to the new stamps

  std::int64_t max_age_us_ = 0;
  double stop_distance_m_ = 0.0;
  bool noiseless_camera_ = false;
  FrameTimeline timeline_;
  FrozenCamera frozen_;
  std::vector<vision::LeaderObserver> observers_;  ///< one a leader
  control::Follower follower_;
  std::vector<Setpoint> setpoints_;  ///< one a leader; `run` is the same in all
  LeaderChoice choice_;
  bool goes_back_ = false;                       ///< alternatives.back_after_s is not 0
  double nearest_m_ = 0.0, farthest_m_ = 0.0;    ///< where another leader may be when it is taken
  std::vector<vision::ObservationResult> seen_;  ///< of each leader in this frame
  LeadersSeen in_view_{};                        ///< in this frame, see in_view()
  std::optional<std::int64_t> looked_utime_;     ///< when the first leader was last looked for in a whole picture
  MonotonicTime now_{std::numeric_limits<std::int64_t>::min()};  ///< the latest that was given
  std::int64_t measured_utime_ = 0;                              ///< of what is held
  HeldCommand held_;
  bool needs_ranges_ = false;  ///< control.avoidance.enabled
  std::int64_t max_ranges_age_us_ = 0;
  std::optional<MonotonicTime> ranges_at_;  ///< arrival of the last scan
};

}  // namespace pilotfish
PILOTFISH_API_END
