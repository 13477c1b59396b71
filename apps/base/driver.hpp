#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pilotfish/base/base.hpp"
#include "pilotfish/config/base_file.hpp"
#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::apps {

/// The encoders' readings, integrated.
struct Measured {
  Pose2 pose;
  Twist twist;
};

/// The wheel driver. No call blocks, none throws.
class Driver {
 public:
  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
  virtual ~Driver() = default;

  virtual void drive(const Twist& command, MonotonicTime now) = 0;
  /// Handles what the other side has sent.
  virtual void poll(MonotonicTime now) = 0;
  /// Why the wheels cannot be reached, for display; empty if they can.
  virtual std::string trouble(MonotonicTime now) const = 0;
  /// The other side reports a pressed emergency stop.
  virtual bool emergency_stop() const { return false; }
  /// The measurements since the last call.
  virtual std::optional<Measured> take_measured() { return std::nullopt; }
  virtual std::map<std::string, std::int64_t> counters() const { return {}; }
  /// Waits until the last command has been sent, a twentieth of a second at most. At the end of the program only.
  virtual void drain() {}
};

/// Without wheels of its own: another program may execute NAME_BASE.
std::unique_ptr<Driver> published_driver();

/// Throws SerialError if the line cannot be opened now; later it is tried again every second.
std::unique_ptr<Driver> serial_driver(const std::string& device, const base::BaseConfig& config);

}  // namespace pilotfish::apps
