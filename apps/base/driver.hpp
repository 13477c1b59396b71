#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "pilotfish/base/base.hpp"
#include "pilotfish/config/base_file.hpp"
#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::apps {

/// What the encoders say, integrated.
struct Measured {
  Pose2 pose;
  Twist twist;
};

/// What turns the wheels. No call blocks, none throws.
class Driver {
 public:
  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
  virtual ~Driver() = default;

  virtual void drive(const Twist& command, MonotonicTime now) = 0;
  /// Takes in what the other side has said.
  virtual void poll(MonotonicTime now) = 0;
  /// Why the wheels cannot be reached, for people; empty if they can.
  virtual std::string trouble(MonotonicTime now) const = 0;
  /// The other side reports a pressed emergency stop.
  virtual bool emergency_stop() const { return false; }
  /// What has been measured since the last call.
  virtual std::optional<Measured> take_measured() { return std::nullopt; }
  virtual std::map<std::string, std::int64_t> counters() const { return {}; }
  /// Waits until the last command has been sent, a twentieth of a second at most. At the end of the program only.
  virtual void drain() {}
};

/// The wheels are somebody else's, who listens to NAME_BASE, or nobody's.
std::unique_ptr<Driver> published_driver();

/// Throws SerialError if the line cannot be opened now; later it is tried again every second.
std::unique_ptr<Driver> serial_driver(const std::string& device, const base::BaseConfig& config);

}  // namespace pilotfish::apps
