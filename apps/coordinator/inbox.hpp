#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>
#include <vector>

#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "pilotfish/core/range_scan.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/twist.hpp"

namespace pilotfish::apps {

/// A picture that has arrived and has not been decoded: of many, only the newest is decoded.
struct PendingFrame {
  MonotonicTime at;
  std::function<std::optional<Frame>()> decode;  ///< nothing: it was refused, and counted where that was noticed
  /// The image_t, if the picture came as a JPEG: for the black box.
  std::shared_ptr<const std::vector<std::uint8_t>> jpeg_message;
};

/// The coordinator's inputs between frames, in the order of arrival.
struct ReceivedSetpoint {
  Setpoint setpoint;
  std::int64_t counter = 0;         ///< of the operator
  std::int64_t stops_received = 0;  ///< by the sender of commands when this came, see CommandSender
};
struct ReceivedMotion {
  std::int64_t utime = 0;
  Twist twist;
  bool of_the_leader = false;
};
struct ReceivedRanges {
  std::shared_ptr<const RangeScan> scan;
  MonotonicTime at;
};
using Received = std::variant<ReceivedSetpoint, ReceivedMotion, ReceivedRanges>;

/// From the receiving threads (bus, camera) to the vision thread. Never waits for the latter: a newer frame
/// replaces an older one, and of a flood of messages the oldest are dropped.
class Inbox {
 public:
  void put(PendingFrame frame);
  void put(const Received& received);

  struct Taken {
    std::optional<PendingFrame> frame;
    std::vector<Received> received;
  };
  /// What there is, waiting `timeout` at most for the first of it.
  Taken take(std::chrono::microseconds timeout);
  void wake();  ///< take() returns at once, with nothing

  std::int64_t overtaken() const;  ///< frames that were replaced before they were processed
  std::int64_t forgotten() const;  ///< messages that did not fit

 private:
  static constexpr std::size_t kMaxReceived = 256;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<PendingFrame> newest_;
  std::deque<Received> received_;
  bool woken_ = false;
  std::int64_t overtaken_ = 0, forgotten_ = 0;
};

}  // namespace pilotfish::apps
