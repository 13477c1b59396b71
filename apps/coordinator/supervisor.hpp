#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "command_sender.hpp"
#include "inbox.hpp"
#include "service_notify.hpp"

namespace pilotfish::apps {

/// Takes the signals, reports progress to the service manager (of both the command thread and the vision thread;
/// a thread of its own would prove nothing), and ensures that the program ends: at once
/// if requested, even if a thread is stuck.
class Supervisor {
 public:
  Supervisor(CommandSender& sender, Inbox& inbox);
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  void ready(const std::string& source);  ///< once: to the service manager
  void ended() { service_.stopping(); }   ///< the source has
  void looked() { ++turns_; }             ///< one turn of the control loop
  bool stop_requested() const { return stopping_; }
  bool failed() const { return failed_; }
  /// From any thread: zeros, and the end.
  void fail(const std::string& problem);

 private:
  void stop(Reason reason);
  void watch();
  void run();

  CommandSender& sender_;
  Inbox& inbox_;
  ServiceNotify service_;
  std::atomic<bool> ready_{false}, ending_{false}, stopping_{false}, failed_{false}, over_{false};
  std::atomic<std::int64_t> turns_{0};
  std::int64_t last_turns_ = -1, last_beats_ = -1;
  MonotonicTime looked_at_;  ///< when the control loop last made progress
  std::thread finishing_;    ///< once a signal came; it may be stuck where the sender is
  std::thread thread_;       // last: it uses everything above
};

}  // namespace pilotfish::apps
