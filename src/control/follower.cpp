#include "pilotfish/control/follower.hpp"

#include <utility>

namespace pilotfish::control {

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

Follower::Follower(FollowerConfig config) : config_(std::move(config)) {
  check_ranges(config_.velocity, "control.velocity");
  check_ranges(config_.heading, "control.heading");
  check_ranges(config_.limits, "control.limits");
  fuzzy::prove(config_.law);
  if (config_.profile == Profile::anticipate)
    throw ConfigError("profile", "'anticipate' is not available in this version; use 'paper'");
}

FollowerOutput Follower::follow(const Observation& observation, const Setpoint& setpoint) {
  // The first measurement after a rest has no past: ec = 0, and the limits count one control period from standstill.
  const double dt_s =
      last_utime_ ? static_cast<double>(observation.utime - *last_utime_) * 1e-6 : config_.velocity.control_period_s;
  FollowerOutput output;
  output.velocity =
      fuzzy_velocity(config_.law, config_.velocity, setpoint.distance_m, observation.distance_m, last_error_m_, dt_s);
  const Twist wanted{output.velocity.linear_mps,
                     heading_turn_rate(config_.heading, observation.bearing_rad, setpoint.bearing_rad)};
  output.command = limit(config_.limits, wanted, last_command_, dt_s);

  last_utime_ = observation.utime;
  last_error_m_ = output.velocity.error_m;
  last_command_ = output.command;
  return output;
}

void Follower::restart() {
  last_utime_.reset();
  last_error_m_.reset();
  last_command_ = Twist{};
}

}  // namespace pilotfish::control
