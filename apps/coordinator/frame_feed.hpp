#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "pilotfish/bus/bus.hpp"
#include "pilotfish/capture/frame_source.hpp"
#include "pilotfish/core/frame.hpp"

namespace pilotfish::apps {

using MonotonicClock = std::chrono::steady_clock;

/// A frame and when it reached this program.
struct Arrival {
  Frame frame;
  MonotonicClock::time_point at;
};

/// Frames for the control loop, which must never wait for them longer than it wants to.
class FrameFeed {
 public:
  virtual ~FrameFeed() = default;
  /// The newest frame, waiting `timeout` at most. Frames that were overtaken by a newer one are gone.
  virtual std::optional<Arrival> wait(std::chrono::milliseconds timeout) = 0;
  virtual bool ended() const = 0;
};

/// Frames that wait to be asked for (files): every one of them counts, and none is ever late.
std::unique_ptr<FrameFeed> pull_feed(std::function<std::optional<Frame>()> next);

/// Frames of a live source, read on a thread of its own, because a camera that was pulled out can block read() for 10
/// s. When the source ends it is opened again every second with `open`, which may throw CaptureError (logged).
std::unique_ptr<FrameFeed> camera_feed(std::unique_ptr<capture::FrameSource> first,
                                       std::function<std::unique_ptr<capture::FrameSource>()> open);

/// Images of one LCM channel. wait() also handles every other message of the bus.
std::unique_ptr<FrameFeed> bus_feed(bus::Bus& bus, const std::string& channel);

}  // namespace pilotfish::apps
