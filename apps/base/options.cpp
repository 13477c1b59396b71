#include "options.hpp"

#include <CLI/CLI.hpp>

#include "exit_codes.hpp"
#include "usage_errors.hpp"
#include "version.hpp"

namespace pilotfish::apps {
namespace {

constexpr const char* kExamples = R"(
It accepts one sender of NAME_COMMAND, limits speed, turn rate and acceleration once more, and sets the wheels to zero by
itself 95 ms after the last good command. A stop (a setpoint_t on NAME_SETPOINT with run = false) is accepted from anyone
and lasts until the sender's session is resumed. Its state is published on NAME_BASE, wheel odometry on NAME_POSE.

Examples
  pilotfish-base --config base.yaml
      publishes the wheels' command on NAME_BASE: nothing moves
  pilotfish-base --config base.yaml --driver serial:/dev/ttyUSB0
      the robot; the controller's protocol: docs/base-serial-protocol.md
  pilotfish-base --config base.yaml --driver simulator
      between a coordinator and  pilotfish-sim --realtime --drive-by base

Ends with 0 on SIGINT, SIGTERM and the like, with the wheels at zero; 64 on a wrong command line, 69 if the bus or the
serial line cannot be opened or another base of this name is running, 70 if it gave up, 78 on a bad configuration (the message
names the key). The keys of the configuration: pilotfish-base --describe-config)";

}  // namespace

ParsedBaseOptions parse_base_options(int argc, char** argv) {
  BaseOptions options;
  CLI::App app{"Drives the wheels on one coordinator's commands, and stops them when these end.", "pilotfish-base"};
  app.footer(kExamples);
  app.set_version_flag("--version", std::string("pilotfish-base ") + kVersion, "print the version and end");
  add_config_options(app, options, "data/config/base.yaml");
  app.add_option("--driver", options.driver,
                 "what turns the wheels: dry_run, simulator or serial:DEVICE; instead of the configuration's");
  app.add_option("--lcm-url", options.lcm_url, "LCM bus. Default: $LCM_DEFAULT_URL, else this host alone");
  app.add_flag("--quiet", options.quiet,
               "log warnings only; without it a summary is logged every 2 s, and every change of the state");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return {options, answer_usage(app, error)};
  }
  return {options, std::nullopt};
}

}  // namespace pilotfish::apps
