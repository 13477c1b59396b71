#pragma once

#include <cstdint>
#include <limits>

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/planar_motion.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// A robot's pose and real twist.
struct UnicycleState {
  Pose2 pose;   ///< Pose2 of the base in the world frame
  Twist twist;  ///< the real Twist, in the base frame
};

/// A drive's limits and delays, and its errors in executing commands. The defaults are an ideal drive's.
struct DriveConfig {
  PILOTFISH_PARAMETERS(DriveConfig);
  PILOTFISH_PARAMETER(double, max_linear_mps, 0.6, 0.0, 20.0, "top speed, forwards and backwards");
  PILOTFISH_PARAMETER(double, max_linear_acceleration_mps2, 1.0, 1e-3, 1e3, "greatest change of the set speed");
  PILOTFISH_PARAMETER(double, max_angular_radps, 2.0, 0.0, 50.0, "top turn rate, either way");
  PILOTFISH_PARAMETER(double, max_angular_acceleration_radps2, 10.0, 1e-3, 1e4, "greatest change of the set turn rate");
  PILOTFISH_PARAMETER(double, actuator_lag_s, 0.1, 0.0, 5.0, "time constant of the wheels; 0: none");
  PILOTFISH_PARAMETER(double, command_timeout_s, 0.2, 0.0, 60.0,
                      "a command that is not renewed for so long is taken as zero; 0: never");
  PILOTFISH_PARAMETER(double, linear_gain, 1.0, 0.5, 1.5,
                      "real speed over the commanded one, which the top speed bounds");
  PILOTFISH_PARAMETER(double, angular_gain, 1.0, 0.5, 1.5, "real turn rate over the commanded one");
  PILOTFISH_PARAMETER(double, wheel_step_mps, 0.0, 0.0, 1.0, "a wheel's speed can be set in such steps; 0: to any");
  PILOTFISH_PARAMETER(double, track_width_m, 0.3, 0.01, 5.0, "between the wheels; matters for wheel_step_mps alone");
  PILOTFISH_PARAMETER(double, slip, 0.0, -0.5, 0.5, "share of the speed that is lost between wheels and ground");
  PILOTFISH_PARAMETER(double, slip_sigma, 0.0, 0.0, 0.2, "standard deviation of that share, another one every 0.1 s");
};

/// A differential-drive robot behind its wheel driver. A command is clamped to the top speeds; the driver's
/// set value r ramps towards it with the greatest acceleration; the wheels follow r with a first-order lag
/// tau:
///
///   dr/dt = +-a until r reaches the command,   dv/dt = (r - v) / tau
///
/// With wheel_step_mps the command is rounded for each wheel first. On the ground the robot moves with the wheels'
/// twist times the gains, less the slip.
///
/// Both are solved in closed form; only the path between them is not, and is made of arcs with the mean twist
/// of a sub-step of kSubStep_s (error of the position: below 1e-6 m for the speeds of such robots).
class Unicycle {
 public:
  static constexpr double kSubStep_s = 0.001;  ///< [s]
  static constexpr double kSlipTime_s = 0.1;   ///< [s]; for so long the same share of the speed is lost

  /// At rest at `start`. `seed`: of the slip.
  explicit Unicycle(const DriveConfig& drive, const Pose2& start = {}, std::uint64_t seed = 0);

  const UnicycleState& state() const { return state_; }  ///< pose and real twist
  const Twist& set_value() const { return set_value_; }  ///< the driver's ramp
  /// Executes one constant command for duration_s [s]. A command or time that is not finite, or no time, changes
  /// nothing.
  void advance(const Twist& command, double duration_s);

 private:
  Twist to_wheel_steps(Twist twist) const;
  double slip();

  DriveConfig drive_;
  std::uint64_t seed_ = 0;
  double elapsed_s_ = 0.0;
  std::uint64_t slip_interval_ = std::numeric_limits<std::uint64_t>::max();  ///< for which slip_ was drawn
  double slip_ = 0.0;
  UnicycleState state_;
  Twist set_value_;  ///< the driver's ramp r
  Twist wheels_;     ///< what their turning alone would make: v above
};

}  // namespace pilotfish::sim
PILOTFISH_API_END
