#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "pilotfish/api.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/planar_motion.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// The delay with which the wheels follow their commands.
struct DriveModelConfig {
  PILOTFISH_PARAMETERS(DriveModelConfig);
  PILOTFISH_PARAMETER(double, latency_s, 1.0 / 30.0, 0.0, 0.25,
                      "from the exposure to the moment the command for it reaches the wheels");
  PILOTFISH_PARAMETER(double, actuator_lag_s, 0.1, 0.0, 1.0, "time constant of the wheels' speed control; 0: none");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(
      bool, identify, true,
      "learn both from the own commands and what is seen; the two above are where it begins, and are used until the "
      "evidence against them is strong");
  PILOTFISH_PARAMETER(
      double, odometry_filter_s, 0.1, 0.0, 1.0,
      "time constant with which odometry, where there is any, corrects the model of the drive; 0: at once");
};

/// Where the own motion is taken from.
enum class EgoMotionSource {
  commanded,  ///< the own commands, through the model of the drive
  odometry,   ///< measured twists
};
std::string_view to_string(EgoMotionSource source) noexcept;

/// The robot's motion from its own commands: dead reckoning through a model of the drive (latency, a ramp of the
/// set value with the limits' acceleration, first-order lag), in an odometry frame whose origin is its first pose. Only
/// the last second or two matter: the leader is estimated in this frame, and a slow drift of it looks
/// like motion of the leader that a follower has to compensate anyway.
///
/// Where there is odometry, the motion is the model's plus the model's error, which each measured twist updates
/// (through a low-pass, since odometry has noise and the model has not): the error is interpolated linearly from
/// the twist before and held until the next, for kCovered_s at most. So when odometry ends, the result returns to that
/// without it.
///
/// A value: copy it to look ahead. No allocation.
class EgoMotion {
 public:
  /// At rest, where the odometry frame begins.
  EgoMotion(const DriveModelConfig& drive, const LimitsConfig& limits);

  /// From acts_utime on this is the wheels' command; commands come in the order in which they act.
  void command(const Twist& twist, std::int64_t acts_utime) noexcept;
  /// The twist that odometry measured at utime. False, and nothing changes, unless it is finite, within kBeyondLimits
  /// times the limits of the drive, and later than every twist before.
  bool measured(std::int64_t utime, const Twist& twist) noexcept;
  /// Moves on to utime. The first call only sets the clock; a time in the past changes nothing.
  void advance_to(std::int64_t utime) noexcept;

  /// From now on the wheels follow with this lag, and what has not acted yet acts so much later [us] (negative:
  /// earlier).
  void set_delays(double actuator_lag_s, std::int64_t later_by_us) noexcept;

  /// The odometry frame begins anew, here.
  void set_origin() noexcept { pose_ = Pose2{}; }

  std::int64_t utime() const { return utime_; }  ///< the present [us]
  const Pose2& pose() const { return pose_; }    ///< in the odometry frame
  /// The real one, which lags the commands.
  Twist twist() const {
    return {twist_.linear_mps + model_error_.linear_mps, twist_.angular_radps + model_error_.angular_radps};
  }
  /// The driver's ramp, which the wheels follow; of the model.
  const Twist& set_value() const { return set_value_; }
  EgoMotionSource source() const {  ///< at utime()
    return last_measured_utime_ ? EgoMotionSource::odometry : EgoMotionSource::commanded;
  }

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.drive_.actuator_lag_s, self.started_, self.utime_, self.pose_, self.twist_, self.set_value_,
            self.acting_, self.pending_, self.measured_, self.last_measured_utime_, self.model_error_);
  }

  static constexpr double kCovered_s = 0.2;     ///< a measured twist is not used for times further from it
  static constexpr double kBeyondLimits = 1.5;  ///< pushed, or downhill; more is implausible

 private:
  struct Command {
    Twist twist;
    std::int64_t acts_utime = 0;
  };
  struct Measured {
    Twist twist;
    std::int64_t utime = 0;
  };
  void drive_for(double duration_s) noexcept;
  void take_first_pending() noexcept;
  void take_due_measurements() noexcept;
  void forget_odometry() noexcept;

  DriveModelConfig drive_;
  LimitsConfig limits_;
  bool started_ = false;
  std::int64_t utime_ = 0;
  Pose2 pose_;
  Twist twist_, set_value_, acting_;      ///< of the model
  BoundedVector<Command, 16> pending_;    ///< by time; when full, the oldest acts early
  BoundedVector<Measured, 64> measured_;  ///< still ahead of utime_, by time; when full, the oldest is dropped
  std::optional<std::int64_t> last_measured_utime_;  ///< of the last one that utime_ has reached; empty: too long ago
  Twist model_error_;                                ///< measured minus model; zero without odometry
};

}  // namespace pilotfish::control
PILOTFISH_API_END
