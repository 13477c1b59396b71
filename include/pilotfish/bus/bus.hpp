#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "pilotfish/api.hpp"
#include "pilotfish/bus/encoded_image.hpp"
#include "pilotfish/bus/final_message.hpp"
#include "pilotfish/bus/key.hpp"
#include "pilotfish/bus/reports.hpp"
#include "pilotfish/core/range_scan.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::bus {

/// Default: this host alone (ttl=0), with the largest receive buffer a default kernel may grant.
inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";

/// The bus cannot be opened. The message gives the remedy (e.g. the `ip route` command).
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Channel of a robot: "robot1", "COMMAND" -> "ROBOT1_COMMAND". Throws ConfigError unless that is 1 to 63 letters,
/// digits, '_', '-' or '/' (liblcm reads a name as a regular expression).
std::string channel(const std::string& robot, const std::string& what);

/// LCM, checked at this edge: every incoming message is decoded and its sizes, formats and numbers checked, or it
/// is counted in rejected() and dropped. Nothing else in Pilotfish includes an LCM header. One thread per Bus.
class Bus {
 public:
  /// Empty URL: $LCM_DEFAULT_URL, else kDefaultUrl. Any LCM provider works ("memq://" stays inside this Bus).
  /// Throws BusError within half a second if the network does not loop multicast back to this host.
  explicit Bus(const std::string& url = "");
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  const std::string& url() const;  ///< the one in use
  /// The receive buffer that the kernel granted [bytes]; 0 if the provider has no socket. Decides whether images travel
  /// raw.
  int receive_buffer_bytes() const;

  /// From now on commands and setpoints carry a MAC, and only those with a right one are accepted: others are counted
  /// ("command_mac_wrong", "setpoint_mac_wrong"). A stop is passed on whatever its MAC, as a bare one. No other message
  /// is authenticated.
  void set_key(const Key& key);

  /// Called with every published message, as sent: for recordings. From the thread that publishes.
  void on_published(std::function<void(const std::string& channel, const std::vector<std::uint8_t>&)> tap);

  /// Published numbers are always finite: what is not is replaced (a command by zeros) and counted in
  /// rejected(). Only names and setpoints that cannot be right throw (ConfigError).
  void publish(const std::string& robot, const CommandReport& report);
  /// The same command, encoded for sending from a crashing process.
  std::unique_ptr<FinalMessage> final_message(const std::string& robot, const CommandReport& report);
  void publish(const std::string& robot, const ObservationReport& report);  ///< on NAME_OBSERVATION
  void publish(const std::string& robot, const StatusReport& report);       ///< on NAME_STATUS
  void publish(const std::string& robot, const PoseReport& report);         ///< on NAME_POSE
  void publish(const std::string& robot, const MotionReport& report);       ///< on NAME_MOTION
  void publish(const std::string& robot, const BaseReport& report);         ///< on NAME_BASE
  void publish(const std::string& robot, const SetpointReport& report);     ///< on NAME_SETPOINT
  void publish(const std::string& robot, const RangeScan& scan);            ///< on NAME_RANGES; usable ones only
  /// Raw if four of them fit into the receive buffer, else as JPEG of quality 95.
  void publish_image(const std::string& channel, const Frame& frame);
  /// On NAME_PREVIEW, as a JPEG of this quality (1 to 100), `shrink` times smaller on each side: pixel (i, j) is the
  /// mean of the frame's pixels (i shrink to i shrink + shrink - 1, j likewise). The message says so: extra
  /// `pilotfish_shrink`.
  void publish_preview(const std::string& robot, const Frame& frame, int shrink, int quality);

  /// Decodes every picture received. To use only the newest, take on_encoded_image() and decode that one.
  void on_image(const std::string& channel, std::function<void(Frame)> handler);
  /// Passes pictures on as received; see decode().
  void on_encoded_image(const std::string& channel, std::function<void(EncodedImage)> handler);
  /// A stop is accepted from anyone (see SetpointReport). The handler uses a SetpointGate.
  void on_setpoint(const std::string& robot, std::function<void(SetpointReport)> handler);
  /// Messages on NAME_COMMAND.
  void on_command(const std::string& robot, std::function<void(CommandReport)> handler);
  /// Messages on NAME_STATUS.
  void on_status(const std::string& robot, std::function<void(StatusReport)> handler);
  /// Messages on NAME_BASE.
  void on_base(const std::string& robot, std::function<void(BaseReport)> handler);
  /// The robot's speed and turn rate from NAME_POSE; not its pose.
  void on_pose(const std::string& robot, std::function<void(MotionReport)> handler);
  /// The twist that a robot announces of itself on NAME_MOTION.
  void on_motion(const std::string& robot, std::function<void(MotionReport)> handler);

  /// What sonars or a laser measured, on NAME_RANGES: bot_core.planar_lidar_t.
  void on_ranges(const std::string& robot, std::function<void(RangeScan)> handler);

  /// Waits up to timeout_ms for a message, then handles all that have come. Returns how many. A signal ends
  /// the wait. If a handler throws, the messages behind it wait for the next call, and the exception passes
  /// through. One call takes at most 1000 datagrams and 8 MiB off the wire, so that no flood blocks it; then it may
  /// return 0 before the time is up. Between two calls messages wait in the socket's receive buffer, which drops the
  /// NEW ones when full (receive_buffer_full), whatever their channel; with another provider than udpm, liblcm's queue
  /// does, which holds 30 of a channel. So: call often, handle all, use the newest.
  int handle(int timeout_ms);

  /// When the message that is being handled reached this host. It may have waited since, e.g. while this process was
  /// stopped. Of a message in fragments, its first one; of tcpq:// and logs, up to 5 ms before.
  MonotonicTime arrival() const;

  /// Messages dropped at this edge, by kind: "image_corrupt", "setpoint_out_of_bounds", ... Names have at
  /// most 24 letters, so that they fit into a StatusReport.
  const std::map<std::string, std::int64_t>& rejected() const;

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace pilotfish::bus
PILOTFISH_API_END
