#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "pilotfish/api.hpp"
#include "pilotfish/config/bundle.hpp"
#include "pilotfish/coordinator/coordinator.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::blackbox {

/// What is known before the first call.
struct Start {
  std::string robot;            ///< channels are ROBOT_STEP, ROBOT_SENT, ROBOT_BOX
  std::int64_t session = 0;     ///< the coordinator's; 0: it has none
  std::string command_line;     ///< of the program, for people
  config::ConfigBundle config;  ///< what the coordinator is configured with
};

/// Since the start.
struct Counters {
  std::int64_t written = 0;  ///< events written to the operating system
  std::int64_t dropped = 0;  ///< events that did not fit into the queue: the disk is too slow
  std::int64_t lost = 0;     ///< events the disk refused
  std::int64_t files = 0;    ///< begun
};

/// A flight recorder: a bounded ring of files on disk with every call of the core and its answer, every command
/// that was sent and every message passed to it, as LCM events. From it `pilotfish replay` recomputes each
/// command bit for bit.
///
/// Nothing here can delay or stop the robot: recording copies into a queue that is bounded in bytes, and returns;
/// what does not fit is dropped and counted. A thread of its own writes each event with one write(2), so that SIGKILL
/// loses only what is still in the queue, and a power cut the last two seconds. A full disk first loses the oldest
/// files, then the newest events, which are counted; a blocking disk loses events, but delays no caller.
///
/// After a gap the next frame's call also records the core's state, so that a replay can continue after it.
class BlackBox {
 public:
  /// Throws ConfigError naming black_box.directory if it is not writable, or another black box writes there.
  /// `core` as it is before the first call.
  BlackBox(const config::BlackBoxConfig& config, Start start, const Coordinator& core);
  /// Waits two seconds at most for the disk.
  ~BlackBox();
  BlackBox(const BlackBox&) = delete;
  BlackBox& operator=(const BlackBox&) = delete;

  /// Each call of the core, right after it, in order and from the thread that makes them. Of the frame all but
  /// its pixels: picture() and message() record those.
  void frame(const Frame& frame, MonotonicTime now, const StepResult& result, const Coordinator& core) noexcept;
  /// Coordinator::set_setpoint(), and what it returned.
  void setpoint(const Setpoint& setpoint, bool taken, const Coordinator& core) noexcept;
  /// Coordinator::set_ego_motion(), and what it returned.
  void ego_motion(std::int64_t utime, const Twist& twist, bool taken, const Coordinator& core) noexcept;
  /// Coordinator::set_leader_intent(), and what it returned.
  void leader_intent(std::int64_t utime, const Twist& twist, bool taken, const Coordinator& core) noexcept;
  /// Coordinator::set_ranges(), and what it returned.
  void ranges(const RangeScan& scan, MonotonicTime now, bool taken, const Coordinator& core) noexcept;

  // From any thread.

  /// A command that was sent: `sent` follows from the command that the sender held and the reason for what was missing.
  void sent(const HeldCommand& held, MonotonicTime now, Reason missing, const HeldAnswer& sent, std::int64_t session,
            std::int64_t counter) noexcept;
  /// A message as it went over the bus. An image_t with a JPEG on ROBOT_IMAGE lets a replay repeat the vision, too.
  void message(std::string_view channel, const void* data, std::size_t size_bytes) noexcept;
  /// A raw picture: at black_box.picture_rate_hz one is kept on ROBOT_IMAGE, as a JPEG of quality 95 for viewing, or
  /// with black_box.raw_pictures as it is. Encoded by the box's own thread; the pixels are shared, if the frame owns
  /// them.
  void picture(const Frame& frame) noexcept;

  Counters counters() const noexcept;  ///< since the start
  std::string trouble() const;         ///< the disk's last error, as a text; empty if there was none

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  ///< with the writing thread, which may outlive this if the disk hangs
};

/// Version, processor and compiler of this library: only the same ones give the same bits.
std::string program_description();

}  // namespace pilotfish::blackbox
PILOTFISH_API_END
