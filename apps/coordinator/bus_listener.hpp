#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "command_sender.hpp"
#include "control_loop.hpp"
#include "inbox.hpp"
#include "pilotfish/bus/bus.hpp"
#include "pilotfish/bus/key.hpp"
#include "pilotfish/core/session_guard.hpp"

namespace pilotfish::apps {

struct ListenerConfig {
  std::string robot;
  std::string url;
  std::optional<bus::Key> key;
  std::int64_t session = 0;
  double stop_distance_m = 0.0;
  Setpoint setpoint;          ///< what is kept at the start
  std::string image_channel;  ///< empty: frames do not come over the bus
  int width = 0, height = 0;  ///< of the pictures that can be used [px]
  bool simulated = false;     ///< stamps of images are no wall clock's
  bool odometry = false;
  bool ranges = false;             ///< control.avoidance.enabled
  std::string leader_intent_from;  ///< empty: none
};

/// Everything that comes over the bus, on a thread of its own: it applies at once what can only stop the robot (a
/// stop, a second coordinator of the same name), and puts the rest into the inbox, pictures undecoded.
class BusListener {
 public:
  /// Throws BusError.
  BusListener(const ListenerConfig& config, std::shared_ptr<Inbox> inbox);
  ~BusListener();
  BusListener(const BusListener&) = delete;
  BusListener& operator=(const BusListener&) = delete;

  /// Whether there was another coordinator of that name within this time. Before start().
  std::optional<std::int64_t> rival_within(int milliseconds);
  /// failed: called once, from the thread, if an exception ends it.
  void start(CommandSender& sender, std::function<void(const std::string&)> failed);
  void stop();

  Counters refused() const;  ///< from any thread
  const bus::Bus& bus() const { return bus_; }

 private:
  std::optional<Frame> decode(const bus::EncodedImage& image, std::int64_t age_us);
  void hear_setpoint(const bus::SetpointReport& asked);
  void run(const std::function<void(const std::string&)>& failed);
  void count_refused();

  const ListenerConfig config_;
  const std::shared_ptr<Inbox> inbox_;
  bus::Bus bus_;
  CommandSender* sender_ = nullptr;  ///< none before start()
  SetpointGate gate_;
  Setpoint kept_;
  Counters refused_setpoints_;
  std::optional<std::int64_t> rival_;
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;  ///< of the two below
  Counters refused_, refused_pictures_;
  std::thread thread_;
};

}  // namespace pilotfish::apps
