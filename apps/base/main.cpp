// pilotfish-base: drives the wheels. Reads the configuration, opens the line and the bus, hands both to the loop.
// Nothing is opened before the configuration is known to be good.

#include <spdlog/spdlog.h>

#include <cstdlib>

#include "driver.hpp"
#include "exit_codes.hpp"
#include "guarded.hpp"
#include "log.hpp"
#include "loop.hpp"
#include "options.hpp"
#include "pilotfish/bus/key.hpp"
#include "pilotfish/config/base_file.hpp"
#include "real_time.hpp"
#include "serial_port.hpp"
#include "service_notify.hpp"
#include "standard_streams.hpp"
#include "stop_on_fault.hpp"
#include "stop_signal.hpp"

namespace pilotfish::apps {
namespace {

using Kind = config::WheelDriver::Kind;

int fail(int code, const std::string& problem) {
  spdlog::critical("{}", problem);
  return code;
}

config::BaseFile load(const BaseOptions& options) {
  config::BaseFile file = config::load_base(options.config_path);
  override_name(options, file.name);
  if (options.driver) file.driver = config::driver_from(*options.driver);
  return file;
}

/// Prints what will be used, so that a log shows the settings.
void log_start(const config::BaseFile& file, const bus::Bus& bus) {
  const base::BaseConfig& config = file.base;
  const std::string driver = file.driver.kind == Kind::serial      ? "serial line " + file.driver.device
                             : file.driver.kind == Kind::simulator ? "simulator"
                                                                   : "dry run: nothing moves";
  spdlog::info("wheels of {}: {}; r = {:.4f} m, {:.3f} m apart", file.name, driver, config.wheels.wheel_radius_m,
               config.wheels.track_width_m);
  spdlog::info("limits {:.2f} m/s, {:.2f} m/s2, {:.2f} rad/s; zero {:.0f} ms after the last good command",
               config.limits.max_linear_mps, config.limits.max_linear_acceleration_mps2,
               config.limits.max_angular_radps, config.commands.max_command_age_s * 1e3);
  if (file.key_file.empty()) spdlog::warn("no key_file: whoever reaches the bus can command the wheels");
  spdlog::info("bus {}", bus.url());
}

int run(const BaseOptions& options) {
  const config::BaseFile file = load(options);
  std::optional<bus::Key> key;
  if (!file.key_file.empty()) key = bus::load_key(file.key_file);
  base::Base base(file.base, bus::new_session_id(), file.driver.kind != Kind::serial);
  ServiceNotify service(service_environment());
  become_real_time("the wheels", kCommandsPriority);  // and the thread that reads the line, which it starts
  try {
    const std::unique_ptr<Driver> driver =
        file.driver.kind == Kind::serial ? serial_driver(file.driver.device, file.base) : published_driver();
    bus::Bus bus(options.lcm_url);
    if (key) bus.set_key(*key);
    log_start(file, bus);
    lock_memory();
    base_loop({file.name, file.base.rate_hz, service_environment().socket.empty()}, base, *driver, bus, service);
  } catch (const bus::BusError& error) {
    return fail(kUnavailable, error.what());
  } catch (const SerialError& error) {
    return fail(kUnavailable, error.what());
  } catch (const AnotherBase& error) {
    return fail(kUnavailable, error.what());
  }
  spdlog::info("ended; the wheels were set to zero");
  return kOk;
}

int run_or_say_why_not(const BaseOptions& options) {
  try {
    return run(options);
  } catch (const ConfigError& error) {
    return fail(kConfig, std::string("bad configuration: ") + error.what());
  } catch (const std::exception& error) {
    return fail(kSoftware, error.what());
  }
}

/// The program, from its command line to its exit code.
int program(int argc, char** argv) {
  fill_missing_standard_streams();
  const ParsedBaseOptions parsed = parse_base_options(argc, argv);
  if (parsed.exit_code) return *parsed.exit_code;
  if (describes_config(parsed.options, config::describe_base_config, config::describe_base_config_as_json_schema))
    return kOk;
  catch_stop_signals();
  prepare_stop_on_fault();
  Log log({true, true});
  if (parsed.options.quiet) spdlog::set_level(spdlog::level::warn);
  const int code = run_or_say_why_not(parsed.options);
  log.drain();
  std::_Exit(code);  // a thread may be stuck in a blocked terminal or a dead line, and joining it would never end
}

}  // namespace
}  // namespace pilotfish::apps

int main(int argc, char** argv) {
  using namespace pilotfish::apps;
  return guarded("pilotfish-base", [argc, argv] { return program(argc, argv); });
}
