#pragma once

#include <array>
#include <cstdint>

#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/planar_motion.hpp"

namespace pilotfish::control {

/// How late the wheels do what they are told.
struct DriveModelConfig {
  double latency_s = 1.0 / 30.0;  ///< from the exposure of a picture to the moment the command that answers it acts
  double actuator_lag_s = 0.1;    ///< time constant of the wheels' speed control
  static const std::vector<Parameter<DriveModelConfig>>& parameters();
};

/// Where the robot has got to by its own commands: dead reckoning through a model of the drive (latency, a ramp of the
/// set value with the limits' acceleration, first-order lag), in an odometry frame that begins where it began. Only
/// what happens within a second or two matters: the leader is estimated in this frame, and a slow drift of it looks
/// like motion of the leader that a follower has to compensate anyway.
///
/// A value: copy it to look ahead. No allocation.
class OwnMotion {
 public:
  OwnMotion(const DriveModelConfig& drive, const LimitsConfig& limits);

  /// From acts_utime on the wheels are told this; commands come in the order in which they act.
  void command(const Twist& twist, std::int64_t acts_utime) noexcept;
  /// Moves on to utime. The first call only sets the clock; a time in the past changes nothing.
  void advance_to(std::int64_t utime) noexcept;

  /// The odometry frame begins anew, here.
  void set_origin() noexcept { pose_ = Pose2{}; }

  std::int64_t utime() const { return utime_; }
  const Pose2& pose() const { return pose_; }
  const Twist& twist() const { return twist_; }  ///< the real one, behind the commands

 private:
  struct Command {
    Twist twist;
    std::int64_t acts_utime = 0;
  };
  void drive_for(double duration_s) noexcept;
  void take_first_pending() noexcept;

  DriveModelConfig drive_;
  LimitsConfig limits_;
  bool started_ = false;
  std::int64_t utime_ = 0;
  Pose2 pose_;
  Twist twist_, set_value_, acting_;
  std::array<Command, 16> pending_;  ///< by time; when full, the oldest acts early
  int pending_count_ = 0;
};

}  // namespace pilotfish::control
