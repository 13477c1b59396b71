#pragma once

#include <string>

#include "driver.hpp"
#include "pilotfish/base/base.hpp"
#include "pilotfish/bus/bus.hpp"
#include "service_notify.hpp"

namespace pilotfish::apps {

struct BaseLoopConfig {
  std::string robot;  ///< name on the bus
  double rate_hz = 50.0;
  bool summary = true;  ///< a line every 2 s
};

/// Another process drives the wheels of this name.
class AnotherBase : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Commands in, wheel speeds out, until a stop signal comes; then zeros. All the waiting, the clock reading and the
/// publishing around Base::step, and nothing else. Throws AnotherBase before anything has moved.
void base_loop(const BaseLoopConfig& config, base::Base& base, Driver& driver, bus::Bus& bus, ServiceNotify& service);

}  // namespace pilotfish::apps
