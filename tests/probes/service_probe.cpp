// Says to the service manager what its arguments say, one after the other: ready=TEXT, status=TEXT, progress=US (an
// instant on the monotonic clock), stopping. Then prints the watchdog's period in us, or "none".

#include <cstdlib>
#include <iostream>
#include <string>

#include "service_notify.hpp"

int main(int argc, char** argv) {
  using namespace pilotfish;
  apps::ServiceNotify service(apps::service_environment());
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    const std::size_t equals = argument.find('=');
    const std::string verb = argument.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : argument.substr(equals + 1);
    if (verb == "ready") {
      service.ready(value);
    } else if (verb == "status") {
      service.status(value);
    } else if (verb == "progress") {
      service.progress(MonotonicTime{std::stoll(value)});
    } else if (verb == "stopping") {
      service.stopping();
    } else {
      return EXIT_FAILURE;
    }
  }
  const auto period = service.watchdog_period();
  std::cout << (period ? std::to_string(period->count()) : "none") << "\n";
  return EXIT_SUCCESS;
}
