#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "pilotfish/control/fuzzy_velocity_law.hpp"
#include "pilotfish/control/heading_controller.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/setpoint.hpp"

namespace pilotfish::control {

/// Which law drives.
enum class Profile {
  paper,       ///< the law as published
  anticipate,  ///< the same law around a feed-forward of the leader's motion, estimated by vision alone
};
std::string_view to_string(Profile profile) noexcept;
/// Throws ConfigError listing the profiles.
Profile profile_from(std::string_view name);

struct FollowerConfig {
  Profile profile = Profile::paper;
  fuzzy::Controller law;  ///< must have passed fuzzy::prove
  FuzzyVelocityConfig velocity;
  HeadingControllerConfig heading;
  LimitsConfig limits;
};

struct FollowerOutput {
  Twist command;             ///< within the limits
  VelocityCommand velocity;  ///< what the fuzzy law said on the way
};

/// The way into this room: Observation in, Twist out. Remembers the last error and the last command, nothing else;
/// time comes from the observations.
class Follower {
 public:
  /// Throws ConfigError if any parameter is out of range.
  explicit Follower(FollowerConfig config);

  FollowerOutput follow(const Observation& observation, const Setpoint& setpoint);

  /// Forget the past: the robot stands still (or was told to). The next follow() starts with ec = 0 from rest.
  void restart();

 private:
  FollowerConfig config_;
  std::optional<std::int64_t> last_utime_;
  std::optional<double> last_error_m_;
  Twist last_command_;
};

}  // namespace pilotfish::control
