#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/base/command_guard.hpp"
#include "pilotfish/base/diff_drive.hpp"
#include "pilotfish/base/stop_latch.hpp"
#include "pilotfish/base/wheel_limits.hpp"
#include "pilotfish/core/parameter.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::base {

/// The speeds of a serial line [baud].
inline constexpr int kBauds[] = {9600,   19200,  38400,  57600,   115200,  230400,
                                 460800, 500000, 921600, 1000000, 2000000, 4000000};

/// The line to the motor controller.
struct SerialConfig {
  PILOTFISH_PARAMETERS(SerialConfig);
  PILOTFISH_PARAMETER(int, baud, 115200, 9600, 4'000'000, "of the serial line; one of the usual numbers");
  PILOTFISH_PARAMETER(double, timeout_s, 0.25, 0.05, 5.0,
                      "a controller that has echoed no line sent within this time cannot be reached: fault, zeros");
};

/// The wheels' process.
struct BaseConfig {
  PILOTFISH_PARAMETERS(BaseConfig);
  PILOTFISH_PARAMETER(double, rate_hz, 50.0, 30.0, 200.0,
                      "lines to the wheels and messages on NAME_BASE per second; more go out when something changes");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, start_stopped, false,
                                    "begin with a latched stop: nothing moves until it is resumed");
  DriveGeometry wheels;         ///< the base's geometry
  WheelLimitsConfig limits;     ///< limits of the wheels
  CommandGuardConfig commands;  ///< which commands to accept, and for how long
  SerialConfig serial;          ///< the line to the motor controller

  template <class Visit>
  static void sections(Visit&& visit) {  ///< see core/sections.hpp
    using C = BaseConfig;
    visit("wheels", &C::wheels);
    visit("limits", &C::limits);
    visit("commands", &C::commands);
    visit("serial", &C::serial);
  }
};

/// What the wheels' process is doing; base_t's STATE_ numbers.
enum class BaseState { waiting, driving, stopped, fault };
std::string_view to_string(BaseState state) noexcept;

/// The command for the wheels, and why.
struct BaseOutput {
  BaseState state = BaseState::waiting;  ///< what the wheels' process is doing
  Twist command;                         ///< after all limits; zero unless `driving`
  std::int64_t accepted_session = 0;     ///< the accepted session; 0: none
};

/// Computes the wheels' command, without a clock, a bus or a line:
///
///   command = limit(last good command) if the driver works, no stop is latched and a good command is young enough;
///   else zero, at once.
///
/// Call step() at every period, with every message, and at deadline().
class Base {
 public:
  /// `own_session`: drawn at random, never 0. `simulated_allowed`: the wheels are not real.
  Base(const BaseConfig& config, std::int64_t own_session, bool simulated_allowed);

  /// Throws ConfigError; call while loading.
  static void check(const BaseConfig& config);

  /// Handles, at `now`, a command that reached this host at `arrived`.
  CommandVerdict receive(const ReceivedCommand& command, MonotonicTime arrived, MonotonicTime now) noexcept;
  /// A setpoint, of which only stop and resume are used here.
  LatchVerdict receive(const ReceivedSetpoint& setpoint, MonotonicTime now) noexcept;
  /// The driver can or cannot be reached.
  void driver_works(bool works) noexcept { driver_works_ = works; }

  /// The command for the wheels at `now`.
  BaseOutput step(MonotonicTime now) noexcept;
  /// When step() must be called again at the latest, because a command gets too old.
  std::optional<MonotonicTime> deadline() const noexcept { return guard_.deadline(); }

  bool stopped() const noexcept { return latch_.stopped(); }      ///< a stop is latched
  std::int64_t session() const noexcept { return own_session_; }  ///< of this process; commands name it
  /// What was refused, by name; only counts above zero.
  std::map<std::string, std::int64_t> rejected() const;

 private:
  BaseConfig config_;
  std::int64_t own_session_;
  CommandGuard guard_;
  StopLatch latch_;
  bool driver_works_ = true;
  Twist last_command_;
  std::optional<MonotonicTime> last_command_at_;
  std::array<std::int64_t, kCommandVerdicts> refused_commands_{};
  std::int64_t refused_other_session_ = 0, refused_replayed_ = 0;
};

}  // namespace pilotfish::base
PILOTFISH_API_END
