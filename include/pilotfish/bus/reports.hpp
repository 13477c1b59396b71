#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/core/telemetry.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::bus {

/// pilotfish.command_t, out and in.
struct CommandReport {
  std::int64_t utime = 0;             ///< exposure of the image it answers; of the last one, if there is no new one
  std::int64_t session = 0;           ///< the sender's (new_session_id()); 0: never accepted
  std::int64_t counter = 0;           ///< one more with every command sent in this session
  std::int64_t base_session = 0;      ///< of the wheels' process, as received by the sender; 0: none
  std::int64_t valid_until_us = 0;    ///< its measurement is too old from then on, by the base's clock; 0 for zeros
  Twist command;                      ///< Twist for the wheels, in the robot's base frame
  bool simulated = false;             ///< never for real wheels
  Status status = Status::searching;  ///< Status of the coordinator
  Reason reason = Reason::none;       ///< Reason for the status
};

/// pilotfish.setpoint_t, out and in; to be checked by SetpointGate. A stop without a right MAC, or with invalid
/// numbers, is passed on as a bare stop: session and counter 0.
struct SetpointReport {
  std::int64_t utime = 0;    ///< when it was sent [us]
  std::int64_t session = 0;  ///< of the coordinator it is meant for
  std::int64_t counter = 0;  ///< higher than every one that this session has accepted
  Setpoint setpoint;         ///< Setpoint to keep
};

/// Refusals by reason. Names have at most 24 letters.
using Counters = std::map<std::string, std::int64_t>;

/// pilotfish.base_t, out and in.
struct BaseReport {
  /// What the wheels' process is doing: base_t's STATE_ numbers.
  enum class State { waiting, driving, stopped, fault };
  std::int64_t utime = 0;             ///< when it was sent [us]
  std::int64_t session = 0;           ///< of the wheels' process; commands name it
  std::int64_t counter = 0;           ///< one more with every report of this session
  std::int64_t monotonic_us = 0;      ///< the clock of the wheels' process when it was sent; 0: not known
  std::int64_t accepted_session = 0;  ///< the session whose commands are accepted; 0: none
  Twist command;                      ///< the wheels' command, after all limits
  std::optional<Twist> measured;      ///< Twist measured by the encoders; nothing without them
  bool stopped = false;               ///< latched
  State state = State::waiting;       ///< what the wheels' process is doing
  std::string text;                   ///< for display; at most 80 letters are sent
  Counters rejected;                  ///< at most 16 are sent
};

/// pilotfish.observation_t, out.
struct ObservationReport {
  std::int64_t utime = 0;                  ///< exposure of the frame [us]
  std::optional<Observation> observation;  ///< Observation of that frame, or nothing
  Reason reason = Reason::none;            ///< why there is no observation; Reason.none if there is
  double latency_s = 0.0;                  ///< from the frame's arrival to this message
};

inline constexpr std::size_t kStatusRules = 56;

/// How long a stage of the control loop took: pilotfish.stage_t.
struct StageReport {
  std::string name;  ///< at most 12 letters
  /// how often less than 0.25, 0.5, 1, ... 128 ms (and not less than the one before), or longer
  std::array<std::int32_t, 11> counts{};
  double max_ms = 0.0;  ///< the longest time [ms]
};

/// A number of pilotfish.status_t.
struct StatusField {
  const char* name;  ///< with its unit, as on the wire
  const char* unit;  ///< e.g. "m/s"; empty: it has none
  const char* text;  ///< what it is
};

/// pilotfish.status_t, out and in.
struct StatusReport {
  std::int64_t utime = 0;             ///< exposure [us] of the image this answers
  Status status = Status::searching;  ///< what the coordinator is doing
  Reason reason = Reason::none;       ///< Reason for the status
  std::string detail;                 ///< the reason's numbers, for people; at most 120 letters are sent, with the text
#define PILOTFISH_FRAME_MEMBER(type, name, unit, source, value, text) type name{};
#define PILOTFISH_LOOP_MEMBER(type, name, unit, value, text) type name{};
  PILOTFISH_STATUS_FIELDS(PILOTFISH_FRAME_MEMBER, PILOTFISH_LOOP_MEMBER)
#undef PILOTFISH_LOOP_MEMBER
#undef PILOTFISH_FRAME_MEMBER
  /// Of the rules, in [0, 1], row by row: E from NB to PB, within it EC from NB to PB.
  std::array<double, kStatusRules> strengths{};
  Setpoint setpoint;                ///< Setpoint that is kept
  std::vector<StageReport> stages;  ///< at most 6 are sent
  Counters rejected;                ///< as many as fit are sent with one message, and the others with the next

  /// Its numbers, in the order of the wire: calls visit(StatusField, pointer to the member) for each.
  template <class Visit>
  static void fields(Visit&& visit) {
#define PILOTFISH_FRAME_FIELD(type, name, unit, source, value, text) \
  visit(StatusField{#name, unit, text}, &StatusReport::name);
#define PILOTFISH_LOOP_FIELD(type, name, unit, value, text) visit(StatusField{#name, unit, text}, &StatusReport::name);
    PILOTFISH_STATUS_FIELDS(PILOTFISH_FRAME_FIELD, PILOTFISH_LOOP_FIELD)
#undef PILOTFISH_LOOP_FIELD
#undef PILOTFISH_FRAME_FIELD
  }
};

/// A robot's true pose in the world: bot_core.pose_t.
struct PoseReport {
  std::int64_t utime = 0;  ///< time of the pose [us]
  /// In the world frame [m], [rad].
  double x_m = 0.0, y_m = 0.0, heading_rad = 0.0;
  Twist velocity;  ///< Twist in the robot's base frame
};

/// A robot's twist at a time: out and in as pilotfish.motion_t, in also from bot_core.pose_t.
struct MotionReport {
  std::int64_t utime = 0;  ///< time of the twist [us]
  Twist twist;             ///< Twist in the robot's base frame
};

}  // namespace pilotfish::bus
PILOTFISH_API_END
