#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "command_sender.hpp"
#include "inbox.hpp"
#include "log.hpp"
#include "pilotfish/blackbox/black_box.hpp"
#include "pilotfish/bus/bus.hpp"
#include "pilotfish/bus/encoded_image.hpp"
#include "pilotfish/coordinator/coordinator.hpp"
#include "preview.hpp"

namespace pilotfish::apps {

struct LoopConfig {
  std::string robot;  ///< name on the bus
  std::int64_t session = 0;
  double frame_rate_hz = 30.0;  ///< also the rate at which the status goes out when no frame comes
  bool simulated = false;       ///< frames carry a simulated time
  bool json = false;
  bool summary = true;                ///< a line every 2 s
  double max_age_s = 0.1;             ///< safety.max_age_s
  bus::ImageSize calibrated;          ///< of the camera
  double configured_latency_s = 0.0;  ///< control.drive.latency_s, to compare with the measured one
  bool publish_intent = false;        ///< on NAME_MOTION
};

/// Counters of other parts, for the status: refused by the bus, ...
using Counters = std::map<std::string, std::int64_t>;

/// Everything around the control loop.
struct LoopParts {
  Inbox& inbox;
  /// Files: the next frame at each call, nothing at the end. Empty: frames come into the inbox.
  std::function<std::optional<Frame>()> pull;
  CommandSender& sender;
  bus::Bus& reports;  ///< for observation and status; used by this thread alone
  Log& log;
  std::function<Counters()> refused;
  std::function<bool()> stop_requested;
  std::function<void()> progress;           ///< called at every turn
  blackbox::BlackBox* black_box = nullptr;  ///< may be none
  Preview* preview = nullptr;               ///< may be none
};

/// Takes the newest frame, steps the coordinator, passes the answer to the sender of commands, reports. It has
/// no time limit; the wheels do not wait for it. Returns when the source has ended or a stop was requested.
void control_loop(const LoopConfig& config, const LoopParts& parts, Coordinator& coordinator);

}  // namespace pilotfish::apps
