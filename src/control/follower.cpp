#include "pilotfish/control/follower.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <sstream>
#include <utility>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/sections.hpp"
#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {

namespace {

[[noreturn]] void refuse_name(std::string_view name, const std::string& owner) {
  throw ConfigError("law", "'" + std::string(name) + "' " + owner + "; a law of your own needs another name");
}

/// A file says `law: NAME` and has a section control.NAME: so NAME must be neither another law's nor another section's.
void check_is_no_other_word(std::string_view name) {
  const auto fits = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (name.empty() || !std::all_of(name.begin(), name.end(), fits))
    refuse_name(name, "is not one word of a to z, 0 to 9 and _");
  if (name == kFuzzyLaw) refuse_name(name, "is the fuzzy law");
  FollowerConfig::sections([&](std::string_view section, auto) {
    if (name == section) refuse_name(name, "is a section of the configuration's `control`");
  });
}

bool is_there(const std::vector<LawDescription>& laws, std::string_view name) {
  return std::any_of(laws.begin(), laws.end(), [&](const LawDescription& law) { return law.name == name; });
}

// Of the delays in use, towards those identified [s per s].
constexpr double kLatencyRate = 0.1, kLagRate = 0.3, kLongestStep_s = 0.1;

constexpr Twist kNoTwist{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

/// d' = v_r - v cos(theta): with a leader beside or behind the robot, cos(theta) <= 0, driving forward leads away from
/// it, and every law here assumes the opposite. So the robot turns to it first.
Twist turn_first(const Twist& wanted, double bearing_rad) noexcept {
  return std::abs(bearing_rad) < kPi / 2.0 ? wanted : Twist{0.0, wanted.angular_radps};
}

/// A leader that brakes less hard than the robot would have the gap smallest before both stand; the guard would be
/// wrong.
void check_leader_deceleration(const FollowerConfig& config) {
  const double leader = config.guard.leader_deceleration_mps2, own = config.limits.max_linear_acceleration_mps2;
  if (leader == 0.0 || leader >= own) return;
  std::ostringstream problem;
  problem << leader << " is below control.limits.max_linear_acceleration_mps2, " << own
          << "; give at least that, or 0 for a leader that may stop dead";
  throw ConfigError("control.guard.leader_deceleration_mps2", problem.str());
}

/// Without them it would not be known that there is room to turn.
void check_search(const FollowerConfig& config) {
  if (!config.search.search_by_rotating || config.avoidance.enabled) return;
  throw ConfigError("control.search.search_by_rotating", "needs ranges all around: set control.avoidance.enabled, too");
}

bool are_finite(const Observation& observation, const Setpoint& setpoint) noexcept {
  return std::isfinite(observation.distance_m) && std::isfinite(observation.bearing_rad) &&
         std::isfinite(setpoint.distance_m) && std::isfinite(setpoint.bearing_rad);
}

}  // namespace

void check_own_law_name(std::string_view name) {
  check_is_no_other_word(name);
  if (is_there(built_in_laws(), name)) refuse_name(name, "comes with Pilotfish");
}

void add_law(FollowerConfig& config, LawDescription law) {
  check_own_law_name(law.name);
  if (is_there(config.laws, law.name)) refuse_name(law.name, "is there already");
  config.laws.push_back(std::move(law));
}

void check_law_names(const FollowerConfig& config) {
  std::vector<std::string_view> names;
  for (const LawDescription& law : config.laws) {
    check_is_no_other_word(law.name);
    if (std::find(names.begin(), names.end(), law.name) != names.end()) refuse_name(law.name, "is there twice");
    names.push_back(law.name);
  }
}

std::vector<std::string> law_names(const FollowerConfig& config) {
  std::vector<std::string> names = {kFuzzyLaw};
  for (const LawDescription& law : config.laws) names.push_back(law.name);
  return names;
}

void set_active_law(FollowerConfig& config, const std::string& name) {
  const std::vector<std::string> names = law_names(config);
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    std::string choices;
    for (const std::string& each : names)
      choices += (choices.empty() ? "" : each == names.back() ? " or " : ", ") + each;
    throw ConfigError("law", "'" + name + "' is not a law; choose " + choices);
  }
  config.active_law = name;
}

std::string_view to_string(Profile profile) noexcept {
  switch (profile) {
    case Profile::paper: return "paper";
    case Profile::anticipate: return "anticipate";
  }
  return "unknown";
}

Profile profile_from(std::string_view name) {
  for (Profile profile : {Profile::paper, Profile::anticipate})
    if (name == to_string(profile)) return profile;
  throw ConfigError("profile", "'" + std::string(name) + "' is not a profile; choose paper or anticipate");
}

bool uses_section(const FollowerConfig& config, std::string_view section) noexcept {
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), section) != names.end();
  };
  if (is_one_of({"limits", "guard", "spacing", "leader_motion", "drive", "avoidance", "search"})) return true;
  if (config.active_law != kFuzzyLaw) return section == config.active_law;
  return is_one_of({"velocity", "heading"}) ||
         (config.profile == Profile::anticipate && is_one_of({"anticipate", "leader_intent"}));
}

Follower::Follower(FollowerConfig config)
    : config_(std::move(config)),
      own_(config_.drive, config_.limits),
      leader_(config_.leader_motion),
      intent_(config_.leader_intent),
      identifier_(config_.drive, config_.limits),
      latency_s_(config_.drive.latency_s),
      actuator_lag_s_(config_.drive.actuator_lag_s),
      avoidance_(config_.avoidance),
      search_(config_.search) {
  check_tree(config_, "control");
  check_search(config_);
  check_leader_deceleration(config_);
  check_law_names(config_);
  for (LawDescription& law : config_.laws)
    for (const LawParameter& parameter : law.parameters) set_parameter(law, parameter.key, parameter.value);
  set_active_law(config_, config_.active_law);
  for (const LawDescription& law : config_.laws) {
    if (law.name != config_.active_law) continue;
    if (law.make) other_law_ = law.make(law.parameters, config_.limits);
    // Else the fuzzy law would drive under another one's name.
    if (!other_law_) throw ConfigError("control." + law.name, "cannot be made: its description makes no law");
  }
  if (!other_law_ || !config_.law.rules.consequents.empty()) fuzzy::validate(config_.law);
  config_.velocity = with_headway(config_.spacing, config_.velocity);
  config_.anticipate = with_headway(config_.spacing, config_.anticipate);
}

FollowerOutput Follower::follow(const Observation& observation, const Setpoint& asked) {
  if (paused_) resume(observation.utime);
  // The first measurement after a rest has no predecessor: ec = 0, and the limits count one control period from
  // standstill.
  const double dt_s =
      last_utime_ ? seconds_between(*last_utime_, observation.utime) : config_.velocity.control_period_s;
  advance_own_to(observation.utime);
  FollowerOutput output;
  Setpoint setpoint = asked;
  Twist wanted_twist = kNoTwist;
  ObstacleView obstacles;
  const bool finite = are_finite(observation, asked);
  if (finite && config_.avoidance.enabled) {
    if (!ranges_.fresh_at(observation.utime, config_.avoidance.max_age_s)) {
      restart(observation.utime);
      output.reason = Reason::ranges_not_fresh;
      return output;
    }
    search_.seen(observation.utime, ranges_.heading_rad() + observation.bearing_rad);
    const Disc leader = avoidance_.leader(observation);
    obstacles = ranges_.view(reading_model(config_.avoidance), observation.utime, {}, &leader);
  }
  if (finite) {
    const std::optional<Prediction> prediction = predict(observation, dt_s);
    setpoint =
        with_headway(config_.spacing, asked, prediction ? prediction->leader.radial_mps : own_.twist().linear_mps);
    if (config_.avoidance.enabled)
      setpoint = avoidance_.steer(obstacles, observation, setpoint, config_.view, ranges_.heading_rad(), dt_s,
                                  output.avoidance.emplace());
    output.drive = drive_in_use();
    wanted_twist = wanted(observation, setpoint, prediction, dt_s, output);
    if (is_finite(wanted_twist))
      wanted_twist.linear_mps = std::min(
          wanted_twist.linear_mps,
          guarded_forward_speed(config_.guard, {config_.limits, config_.hold_s, actuator_lag_s_}, gap(observation)));
  }
  output.setpoint = setpoint;
  last_utime_ = observation.utime;
  if (!is_finite(wanted_twist)) {
    restart(observation.utime);
    output.reason = Reason::law_not_finite;
    return output;
  }
  if (output.avoidance)
    wanted_twist = avoidance_.moderate(obstacles, wanted_twist, own_.twist(),
                                       config_.limits.max_linear_acceleration_mps2, dt_s, *output.avoidance);
  output.command = limit(config_.limits, turn_first(wanted_twist, observation.bearing_rad), last_command_,
                         since_last_command_s(dt_s));
  if (output.avoidance) {
    output.command = within_ranges(output.command, observation.utime, *output.avoidance);
    avoidance_.allowed(output.command.linear_mps, wanted_twist.linear_mps, dt_s);
  }

  output.effect_utime = later_s(observation.utime, delay_s());
  own_.command(output.command, acts_utime(observation.utime));
  identifier_.command(output.command, observation.utime);
  last_error_m_ = setpoint.distance_m - observation.distance_m;
  last_command_ = output.command;
  paused_ = false;
  return output;
}

Twist Follower::wanted(const Observation& observation, const Setpoint& setpoint,
                       const std::optional<Prediction>& prediction, double dt_s, FollowerOutput& output) {
  if (other_law_) {
    if (!config_.law.rules.consequents.empty()) as_published(observation, setpoint, dt_s, output);  // to compare with
    return other_law_->follow(observation, setpoint, dt_s);
  }
  const Twist published = as_published(observation, setpoint, dt_s, output);
  if (config_.profile != Profile::anticipate || !prediction) return published;
  return anticipated(observation, setpoint, *prediction, published, dt_s, output);
}

Twist Follower::as_published(const Observation& observation, const Setpoint& setpoint, double dt_s,
                             FollowerOutput& output) {
  output.velocity = fuzzy_velocity(config_.law, config_.velocity, setpoint.distance_m, observation.distance_m,
                                   last_error_m_, dt_s, std::sqrt(std::max(observation.covariance(0, 0), 0.0)));
  return {output.velocity.linear_mps,
          heading_turn_rate(config_.heading, observation.bearing_rad, setpoint.bearing_rad)};
}

/// A command has taken effect one latency after the exposure and one lag later; that is the moment to predict for.
std::optional<Follower::Prediction> Follower::predict(const Observation& observation, double dt_s) noexcept {
  if (!leader_.started()) own_.set_origin();
  leader_.update(observation, own_.pose());
  identify_drive(observation, dt_s);
  if (!leader_.started()) return std::nullopt;
  const std::int64_t effect_utime = later_s(observation.utime, delay_s());
  EgoMotion then = own_;
  then.advance_to(effect_utime);
  return Prediction{effect_utime, then.pose(), then.twist(), seen_from(then.pose(), leader_.at(effect_utime))};
}

Twist Follower::anticipated(const Observation& observation, const Setpoint& setpoint, const Prediction& prediction,
                            const Twist& published, double dt_s, FollowerOutput& output) {
  // A leader intent is checked only against a measurement of this very frame.
  if (intent_.has_intent() && leader_.utime() == observation.utime)
    output.leader_intent = intent_.evaluate(leader_.at(observation.utime), own_.pose(), observation.utime);
  output.ego_motion = own_.source();
  const LeaderMotion leader = output.leader_intent == LeaderIntentUse::used
                                  ? seen_from(prediction.own_pose, intended_leader(prediction.utime))
                                  : prediction.leader;
  const double weight = feed_forward_weight(config_.anticipate, leader);
  const Anticipation anticipation =
      anticipate(config_.law, config_.velocity, config_.anticipate, leader, prediction.own_twist, setpoint);
  output.velocity = anticipation.velocity;
  output.leader = leader;
  output.feed_forward_weight = weight;

  Twist wanted;
  wanted.linear_mps = (1.0 - weight) * published.linear_mps + weight * anticipation.wanted.linear_mps;
  wanted.angular_radps = (1.0 - weight) * published.angular_radps + weight * anticipation.wanted.angular_radps;
  wanted.linear_mps = std::min(wanted.linear_mps, eased_speed(config_.anticipate, config_.limits,
                                                              last_command_.linear_mps, since_last_command_s(dt_s)));
  return keep_in_view(config_.anticipate, config_.view, config_.limits, prediction.leader, wanted);
}

LeaderEstimate Follower::intended_leader(std::int64_t effect_utime) const noexcept {
  const LeaderMotionConfig& motion = config_.leader_motion;
  if (config_.leader_intent.feed_forward)
    return intent_.fed_forward(leader_.at(effect_utime), effect_utime, seconds_between(leader_.utime(), effect_utime));
  const std::int64_t since_utime = std::clamp(intent_.since_utime(), leader_.utime(), effect_utime);
  return predict_leader(intent_.slowed(leader_.at(since_utime)), motion.manoeuvre_velocity_sigma,
                        motion.manoeuvre_turn_sigma, motion.own_position_sigma,
                        seconds_between(since_utime, effect_utime));
}

/// From what was measured in this very frame, which shows a leader that has stopped dead before the estimate does.
Gap Follower::gap(const Observation& observation) const noexcept {
  const std::int64_t acts = acts_utime(observation.utime);
  EgoMotion then = own_;
  then.advance_to(acts);
  LeaderMotion leader;
  if (leader_.started()) leader = seen_from(own_.pose(), leader_.at(observation.utime));
  const double sigmas = config_.guard.safety_sigmas;

  // The measured place in the odometry frame, and from there as the robot will see it.
  const Pose2 &own = own_.pose(), &there = then.pose();
  const double towards_rad = own.heading_rad + observation.bearing_rad;
  const double x = own.x_m + observation.distance_m * std::cos(towards_rad) - there.x_m;
  const double y = own.y_m + observation.distance_m * std::sin(towards_rad) - there.y_m;
  Gap gap;
  gap.bearing_rad = wrap_angle(std::atan2(y, x) - there.heading_rad);
  gap.leaving_mps =
      leader.radial_mps > 0.0 ? std::max(leader.radial_mps - sigmas * leader.radial_sigma_mps, 0.0) : leader.radial_mps;
  gap.distance_m = std::hypot(x, y) + std::min(gap.leaving_mps, 0.0) * seconds_between(observation.utime, acts);
  gap.distance_sigma_m = std::max(leader.distance_sigma_m, std::sqrt(std::max(observation.covariance(0, 0), 0.0)));
  gap.own_mps = then.twist().linear_mps;
  gap.set_mps = then.set_value().linear_mps;
  return gap;
}

std::int64_t Follower::acts_utime(std::int64_t utime) const { return later_s(utime, latency_s_); }

DriveEstimate Follower::drive_in_use() const noexcept {
  DriveEstimate drive = identifier_.estimate();
  drive.latency_s = latency_s_;
  drive.actuator_lag_s = actuator_lag_s_;
  return drive;
}

/// At a bounded rate, so that what dead reckoning has made of the past stays consistent with what comes.
void Follower::identify_drive(const Observation& observation, double dt_s) noexcept {
  if (!config_.drive.identify) return;
  const RelativePose seen = observation.of_this_frame().pose;
  identifier_.observe(observation.utime, seen.distance_m, seen.bearing_rad);
  const DriveEstimate& drive = identifier_.estimate();
  const double latency_step_s = kLatencyRate * std::min(dt_s, kLongestStep_s);
  const double lag_step_s = kLagRate * std::min(dt_s, kLongestStep_s);
  const double before_s = latency_s_;
  latency_s_ += std::clamp(drive.latency_s - latency_s_, -latency_step_s, latency_step_s);
  actuator_lag_s_ += std::clamp(drive.actuator_lag_s - actuator_lag_s_, -lag_step_s, lag_step_s);
  own_.set_delays(actuator_lag_s_, static_cast<std::int64_t>(std::llround((latency_s_ - before_s) * 1e6)));
}

void Follower::pause(std::int64_t held_us) noexcept {
  if (searched_utime_) own_.command(Twist{}, later(acts_utime(*searched_utime_), held_us));
  searched_utime_.reset();
  if (paused_ || !last_utime_) return;
  own_.command(Twist{}, later(acts_utime(*last_utime_), held_us));
  identifier_.command(Twist{}, later(*last_utime_, held_us));
  paused_ = true;
}

/// While the command was zero the driver's set value ramped down. When this frame's command acts it is s, and the drive
/// takes it from there: so s is the command before, one control period ago.
void Follower::resume(std::int64_t utime) noexcept {
  if (seconds_between(*last_utime_, utime) > config_.leader_motion.memory_s) return forget_leader();
  EgoMotion then = own_;
  then.advance_to(acts_utime(utime));
  last_command_ = then.set_value();
}

double Follower::since_last_command_s(double dt_s) const noexcept {
  return paused_ ? std::min(dt_s, config_.velocity.control_period_s) : dt_s;
}

void Follower::restart(std::int64_t since_utime) {
  if (last_utime_) {
    own_.command(Twist{}, std::max(since_utime, acts_utime(*last_utime_)));
    identifier_.command(Twist{}, std::max(since_utime, *last_utime_));
  }
  forget_leader();
}

void Follower::restart_on_new_clock() noexcept {
  DriveModelConfig drive = config_.drive;
  drive.actuator_lag_s = actuator_lag_s_;
  own_ = EgoMotion(drive, config_.limits);
  ranges_.clear();
  search_.restart();
  identifier_.restart_on_new_clock();
  forget_leader();
}

void Follower::change_leader() noexcept {
  identifier_.interrupt();
  leader_.reset();
  intent_.reset();
  if (other_law_) other_law_->restart();
  avoidance_.restart();
  last_error_m_.reset();
}

void Follower::forget_leader() noexcept {
  change_leader();
  searched_utime_.reset();
  last_utime_.reset();
  last_command_ = Twist{};
  paused_ = false;
}

}  // namespace pilotfish::control
