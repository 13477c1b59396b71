#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "frame_feed.hpp"
#include "pilotfish/bus/bus.hpp"
#include "pilotfish/coordinator/coordinator.hpp"
#include "pilotfish/core/session_guard.hpp"

namespace pilotfish::apps {

struct LoopConfig {
  std::string robot;            ///< name on the bus
  double frame_rate_hz = 30.0;  ///< also the rate at which zeros go out when no frame comes
  double max_age_s = 0.1;
  bool every_frame = false;  ///< the feed is a file: no heartbeat between its frames
  bool json = false;
  double configured_latency_s = 0.0;  ///< control.drive.latency_s, to compare with the measured one
};

/// What was heard on the bus and the coordinator could not use.
struct Refused {
  std::int64_t own_motion = 0;
  std::int64_t announcement = 0;
  std::map<std::string, std::int64_t> setpoints;  ///< by SetpointVerdict
};

/// Frames in, commands out, until the feed ends or a stop signal comes; then zeros. All the waiting, the clock reading
/// and the publishing around Coordinator::step, and nothing else.
void control_loop(const LoopConfig& config, FrameFeed& feed, Coordinator& coordinator, bus::Bus& bus,
                  const Refused& refused, const SetpointGate& gate);

}  // namespace pilotfish::apps
