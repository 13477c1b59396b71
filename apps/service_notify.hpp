#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::apps {

/// A service manager's settings in the environment: its socket, and its watchdog period.
struct ServiceEnvironment {
  std::string socket;  ///< $NOTIFY_SOCKET: a path, or '@' and an abstract name; empty: started by hand
  std::optional<std::chrono::microseconds> watchdog_period;  ///< $WATCHDOG_USEC, if it is meant for this process
};
ServiceEnvironment service_environment();
/// The same from the variables' values (nullptr: not set) and this process' id. What cannot be read counts as not set.
ServiceEnvironment service_environment(const char* notify_socket, const char* watchdog_usec, const char* watchdog_pid,
                                       long own_pid);

/// Reports the program's state to systemd (Type=notify). Never blocks and never fails: what the manager cannot take at
/// once is dropped (docs/decisions/0024 says why this is not libsystemd's sd_notify). Without a manager every call does
/// nothing.
class ServiceNotify {
 public:
  explicit ServiceNotify(const ServiceEnvironment& environment);
  ~ServiceNotify();
  ServiceNotify(const ServiceNotify&) = delete;
  ServiceNotify& operator=(const ServiceNotify&) = delete;

  void ready(std::string_view what) const;   ///< once, before the loop: waits 1 s at most
  void status(std::string_view what) const;  ///< one line, on a change: not with every frame
  void stopping() const;                     ///< the end has begun, in order
  /// The loop has made progress. Call at any rate, from one thread: it sends four times a watchdog's
  /// period.
  void progress(MonotonicTime now);

  /// The manager expects progress within this time; nothing: it does not watch.
  std::optional<std::chrono::microseconds> watchdog_period() const { return watchdog_period_; }

 private:
  enum class Urgency { may_be_dropped, must_arrive };
  void send(std::string_view message, Urgency urgency = Urgency::may_be_dropped) const;

  int socket_ = -1;
  std::optional<std::chrono::microseconds> watchdog_period_;
  std::optional<MonotonicTime> last_progress_;
};

}  // namespace pilotfish::apps
