#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/core/twist.hpp"

namespace pilotfish::bus {

/// What goes out as pilotfish.command_t.
struct CommandReport {
  std::int64_t utime = 0;    ///< exposure of the image it answers; of the last one, when none came
  std::int64_t counter = 0;  ///< one more with every command sent
  Twist command;
  Status status = Status::searching;
  Reason reason = Reason::none;
};

/// What goes out as pilotfish.observation_t.
struct ObservationReport {
  std::int64_t utime = 0;
  std::optional<Observation> observation;
  Reason reason = Reason::none;
  double latency_s = 0.0;  ///< from the frame's arrival to this message
};

inline constexpr std::size_t kStatusRules = 56;

/// What goes out as pilotfish.status_t.
struct StatusReport {
  std::int64_t utime = 0;
  Status status = Status::searching;
  Reason reason = Reason::none;
  double error_m = 0.0, error_change_m = 0.0;
  double output = 0.0;  ///< u of the fuzzy law, normalised
  std::array<double, kStatusRules> strengths{};
  Setpoint setpoint;
  double trust = 0.0;  ///< share of the feed-forward in the command
  double leader_radial_mps = 0.0, leader_tangential_mps = 0.0, leader_turn_rate_radps = 0.0;
  std::int8_t own_motion = 0;    ///< status_t's OWN_MOTION_ numbers
  std::int8_t announcement = 0;  ///< status_t's ANNOUNCEMENT_ numbers
  double frame_rate_hz = 0.0;
  double processing_ms = 0.0;
  double latency_s = 0.0;              ///< to the command, over the last frames
  bool latency_from_exposure = false;  ///< else from the frame's arrival
  double configured_latency_s = 0.0;
  std::map<std::string, std::int64_t> rejected;  ///< counters by reason; at most 16, names of at most 24 letters
};

/// A robot's true pose in the world: bot_core.pose_t.
struct PoseReport {
  std::int64_t utime = 0;
  double x_m = 0.0, y_m = 0.0, heading_rad = 0.0;
  Twist velocity;
};

/// A robot's twist at a time: out and in as pilotfish.motion_t, in as what bot_core.pose_t says of it.
struct MotionReport {
  std::int64_t utime = 0;
  Twist twist;
};

}  // namespace pilotfish::bus
