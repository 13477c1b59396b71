#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/control/anticipating_law.hpp"
#include "pilotfish/control/avoidance.hpp"
#include "pilotfish/control/collision_guard.hpp"
#include "pilotfish/control/drive_identifier.hpp"
#include "pilotfish/control/ego_motion.hpp"
#include "pilotfish/control/fuzzy_velocity_law.hpp"
#include "pilotfish/control/heading_controller.hpp"
#include "pilotfish/control/law.hpp"
#include "pilotfish/control/leader_intent.hpp"
#include "pilotfish/control/leader_motion_estimator.hpp"
#include "pilotfish/control/leader_search.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/control/range_field.hpp"
#include "pilotfish/control/spacing.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/status.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

inline constexpr const char* kFuzzyLaw = "fuzzy";

/// How the fuzzy law drives.
enum class Profile {
  paper,       ///< the law as published
  anticipate,  ///< the same law around a feed-forward of the leader's motion, estimated by vision alone
};
std::string_view to_string(Profile profile) noexcept;
/// Throws ConfigError listing the profiles.
Profile profile_from(std::string_view name);

/// Everything a Follower needs.
struct FollowerConfig {
  Profile profile = Profile::anticipate;               ///< how the fuzzy law drives
  fuzzy::Controller law;                               ///< the fuzzy one; may be left empty where another law drives
  FuzzyVelocityConfig velocity;                        ///< of the paper's law
  HeadingControllerConfig heading;                     ///< of the paper's law
  LimitsConfig limits;                                 ///< of every command
  GuardConfig guard;                                   ///< of every command: the distance that is kept at least
  SpacingConfig spacing;                               ///< of every law: a distance that grows with speed
  AnticipateConfig anticipate;                         ///< of profile `anticipate`
  LeaderMotionConfig leader_motion;                    ///< how leaders move
  DriveModelConfig drive;                              ///< the wheels' delay
  std::string active_law = kFuzzyLaw;                  ///< or the name of one of `laws`
  std::vector<LawDescription> laws = built_in_laws();  ///< what may drive instead of the fuzzy law
  FieldOfView view;                                    ///< of the camera, for the guard of `anticipate`
  double hold_s = 0.1;                                 ///< safety.max_age_s, for the guard: how long a command acts
  LeaderIntentConfig leader_intent;                    ///< how the leader intent is used
  AvoidanceConfig avoidance;                           ///< obstacles, as ranges show them; off by default
  SearchConfig search;                                 ///< of a leader that is lost; off by default

  template <class Visit>
  static void sections(Visit&& visit) {  ///< see core/sections.hpp; those of `laws` come besides
    using C = FollowerConfig;
    visit("velocity", &C::velocity);
    visit("heading", &C::heading);
    visit("limits", &C::limits);
    visit("guard", &C::guard);
    visit("spacing", &C::spacing);
    visit("anticipate", &C::anticipate);
    visit("leader_motion", &C::leader_motion);
    visit("drive", &C::drive);
    visit("leader_intent", &C::leader_intent);
    visit("avoidance", &C::avoidance);
    visit("search", &C::search);
  }
};

/// Throws ConfigError, key `law`, if a law of one's own cannot have this name: the fuzzy law, one that comes with
/// Pilotfish or a section of the configuration's `control` (`limits`) has it already.
void check_own_law_name(std::string_view name);
/// Adds a law of one's own to `laws`. Throws ConfigError, key `law`, if its name is taken.
void add_law(FollowerConfig& config, LawDescription law);
/// Throws ConfigError, key `law`, unless every one of `laws` has a name to itself; a Follower does so, too.
void check_law_names(const FollowerConfig& config);
/// The laws that can be active: the fuzzy law, and config.laws.
std::vector<std::string> law_names(const FollowerConfig& config);
/// Throws ConfigError, key `law`, listing them.
void set_active_law(FollowerConfig& config, const std::string& name);
/// Whether a section of the configuration's `control` affects the active law: `pid` does not affect the fuzzy one.
bool uses_section(const FollowerConfig& config, std::string_view section) noexcept;

/// A Follower's answer, with its intermediate results.
struct FollowerOutput {
  Twist command;      ///< within the limits; zero unless `reason` is none
  Setpoint setpoint;  ///< that was kept: with the headway
  /// law_not_finite: the law's twist, the measurement or the setpoint was not finite. The law is reset, as by
  /// restart(), and the next follow() starts from rest. ranges_not_fresh: the same, where avoidance is enabled.
  Reason reason = Reason::none;
  /// The fuzzy law's answer to the measured error or, where it anticipates, to the predicted one. Not used by other
  /// laws.
  VelocityCommand velocity;
  /// Profile `anticipate`, once the leader's motion is known: as predicted for the moment the command has taken effect.
  std::optional<LeaderMotion> leader;
  double feed_forward_weight = 0.0;  ///< share of the feed-forward in the command; 0: the law as published
  EgoMotionSource ego_motion = EgoMotionSource::commanded;  ///< where the own motion was taken from
  LeaderIntentUse leader_intent = LeaderIntentUse::silent;  ///< how the leader intent was used
  /// The drive's delays, as this command assumes them, and how well they are identified.
  std::optional<DriveEstimate> drive;
  std::optional<AvoidanceOutput> avoidance;  ///< where it is enabled
  /// When the command has taken effect, one latency after the exposure and one lag later: the time for which a robot
  /// that is followed announces it.
  std::int64_t effect_utime = 0;
};

/// The entry point of this module: Observation in, Twist out. Time comes from the observations.
///
///   paper       e, ec as measured --> fuzzy law, heading controller --> limits
///   anticipate  own commands, odometry --> EgoMotion --+
///               observation ---------------------------+--> LeaderMotionEstimator --> prediction --> anticipate()
///               leader_intent --> LeaderIntent: checked against that estimate, may slow the prediction down, or with
///                                                 feed_forward change it
///                                                 --> blended with the paper's command by feed_forward_weight -->
///                                                 kept in view --> limits
///   any         own commands, observation --> Gap --> guarded_speed(), an upper bound of the speed before the limits
///   avoidance   ranges, own commands --> RangeField --> Avoidance: shifts the setpoint's bearing before the law
///                                                  --> guarded_by_ranges(), an upper bound of the speed, last of all
class Follower {
 public:
  /// Throws ConfigError if any parameter is out of range.
  explicit Follower(FollowerConfig config);

  /// One measurement, one command, always finite. Time comes from the observations.
  FollowerOutput follow(const Observation& observation, const Setpoint& setpoint);

  /// What odometry measured of this robot, and the leader intent; times as those of the observations.
  /// False, and nothing changes, if it cannot be used. Optional; used by profile `anticipate` alone.
  bool set_ego_motion(std::int64_t utime, const Twist& twist) noexcept { return own_.measured(utime, twist); }
  /// The leader intent; as set_ego_motion().
  bool set_leader_intent(std::int64_t utime, const Twist& twist) noexcept { return intent_.update(utime, twist); }

  /// What sonars or a laser measured, of the same clock; of use only if avoidance is enabled. False, and nothing
  /// changes, if it cannot be used: not is_usable(), or not newer than the last.
  bool set_ranges(const RangeScan& scan) noexcept;

  /// The turn to where the leader was last seen, for a frame without it; zero, and a reason, if it may not turn (any
  /// more): see LeaderSearch. The robot does not translate.
  SearchOutput search(std::int64_t utime) noexcept;

  /// The last command was held for held_us [us] and has been zero since, because no measurement came: dropped pictures,
  /// a short occlusion. The leader's estimate goes on for leader_motion.memory_s after the last measurement; the next
  /// command starts from the speed to which the wheels have slowed down by then, as dead reckoning has it.
  void pause(std::int64_t held_us) noexcept;
  /// Resets the law: from since_utime on the command is zero. The next follow() starts with ec = 0 from
  /// rest; dead reckoning goes on, because the wheels still have to come to rest.
  void restart(std::int64_t since_utime);
  /// The same where the next observation's time is unrelated to those before: dead reckoning is reset, too.
  void restart_on_new_clock() noexcept;
  /// The observations that follow are of another leader, whose motion is unknown: ec = 0, and the leader's estimate
  /// begins anew. Dead reckoning goes on, and the limits still count from the last command.
  void change_leader() noexcept;

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.own_, self.leader_, self.intent_, self.last_utime_, self.last_error_m_, self.last_command_,
            self.paused_, self.identifier_, self.latency_s_, self.actuator_lag_s_, self.ranges_, self.avoidance_,
            self.search_, self.searched_utime_);
    if (self.other_law_) self.other_law_->remember(archive);
  }

 private:
  void forget_leader() noexcept;
  DriveEstimate drive_in_use() const noexcept;
  double delay_s() const noexcept { return latency_s_ + actuator_lag_s_; }
  /// Moves the delays that are used towards those identified.
  void identify_drive(const Observation& observation, double dt_s) noexcept;
  /// After a pause: the speed from which the command for this frame starts.
  void resume(std::int64_t utime) noexcept;
  /// Since the command before this frame's, as the drive's limits count it [s].
  double since_last_command_s(double dt_s) const noexcept;
  /// Leader and robot at the moment at which this frame's command has taken effect.
  struct Prediction {
    std::int64_t utime = 0;  ///< that moment
    Pose2 own_pose;          ///< under unchanged commands
    Twist own_twist;
    LeaderMotion leader;
  };
  /// From this measurement on; nothing while none could be used.
  std::optional<Prediction> predict(const Observation& observation, double dt_s) noexcept;
  /// The output of the active law, not yet limited.
  Twist wanted(const Observation& observation, const Setpoint& setpoint, const std::optional<Prediction>& prediction,
               double dt_s, FollowerOutput& output);
  /// The paper's law.
  Twist as_published(const Observation& observation, const Setpoint& setpoint, double dt_s, FollowerOutput& output);
  /// The command of profile `anticipate`.
  Twist anticipated(const Observation& observation, const Setpoint& setpoint, const Prediction& prediction,
                    const Twist& published, double dt_s, FollowerOutput& output);
  /// The leader when the command has taken effect, as vision and its intent have it.
  LeaderEstimate intended_leader(std::int64_t effect_utime) const noexcept;
  /// To the leader, as the guard has it, when the command for this frame acts.
  Gap gap(const Observation& observation) const noexcept;
  std::int64_t acts_utime(std::int64_t utime) const;
  /// Dead reckoning on to utime, and what the ranges show with it.
  void advance_own_to(std::int64_t utime) noexcept;
  /// The last rule of all: not faster than the ranges allow.
  Twist within_ranges(const Twist& command, std::int64_t utime, AvoidanceOutput& output) const noexcept;

  FollowerConfig config_;
  EgoMotion own_;
  std::unique_ptr<Law> other_law_;  ///< that drives instead of the fuzzy one; none: the fuzzy one drives
  LeaderMotionEstimator leader_;
  LeaderIntent intent_;
  std::optional<std::int64_t> last_utime_;
  std::optional<double> last_error_m_;
  Twist last_command_;
  DriveIdentifier identifier_;
  double latency_s_ = 0.0, actuator_lag_s_ = 0.0;  ///< of the drive, as they are used
  bool paused_ = false;                            ///< the command has been zero since the last measurement expired
  RangeField ranges_;                              ///< empty unless avoidance is enabled
  Avoidance avoidance_;
  LeaderSearch search_;
  std::optional<std::int64_t> searched_utime_;  ///< of the turn that is under way
};

}  // namespace pilotfish::control
PILOTFISH_API_END
