// pilotfish-sim: a scenario as a process on the bus. Reads the scenario, opens the recording and the bus, plays.

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <iostream>

#include "exit_codes.hpp"
#include "guarded.hpp"
#include "options.hpp"
#include "pilotfish/config/scenario_file.hpp"
#include "pilotfish/core/angles.hpp"
#include "play.hpp"
#include "shipped_scenario.hpp"
#include "standard_streams.hpp"
#include "stop_signal.hpp"

namespace pilotfish::apps {
namespace {

int fail(int code, const std::string& problem) {
  spdlog::error("{}", problem);
  return code;
}

sim::Scenario load(const SimOptions& options) {
  sim::Scenario scenario = config::load_scenario(scenario_file(options.scenario_path, data_folders(program_folder())));
  if (options.duration_s) scenario.duration_s = *options.duration_s;
  if (options.seed) scenario.seed = *options.seed;
  return scenario;
}

void log_start(const sim::Scenario& scenario, const bus::Bus& bus, bool real_time) {
  spdlog::info("scenario {}: {}", scenario.name, scenario.description);
  for (const sim::RobotSpec& robot : scenario.robots)
    spdlog::info("robot {}: {}", robot.name,
                 robot.trajectory        ? "drives its trajectory"
                 : robot.follows.empty() ? "takes commands"
                                         : "follows " + robot.follows);
  spdlog::info("{:.1f} s at {:.0f} Hz, seed {}, {}", scenario.duration_s, scenario.frame_rate_hz, scenario.seed,
               real_time ? "in real time" : "in lock-step");
  spdlog::info("bus {} (receive buffer {} bytes)", bus.url(), bus.receive_buffer_bytes());
}

void summarise(const RunSummary& played, const sim::World& world) {
  spdlog::info("{} after {:.2f} s: {} exposures, {} pictures delivered, {} dropped, {} sent again, {} skipped",
               played.stopped ? "stopped" : "over", world.time_s(), played.frames, played.delivered, played.dropped,
               played.sent_again, played.skipped);
  for (const sim::RobotSpec& robot : world.scenario().robots) {
    if (robot.follows.empty()) continue;
    const RelativePose truth = world.true_relative_pose(robot.name);
    spdlog::info("{} is {:.3f} m from {} at {:.1f} deg", robot.name, truth.distance_m, robot.follows,
                 degrees(truth.bearing_rad));
  }
}

int run(const SimOptions& options) {
  sim::World world(load(options));
  std::optional<bus::Key> key;
  if (!options.key_path.empty()) key = bus::load_key(options.key_path);
  std::ofstream csv;
  if (!options.record_path.empty()) {
    csv.open(options.record_path);
    if (!csv) return fail(kUnavailable, "cannot write the recording " + options.record_path);
  }
  try {
    bus::Bus bus(options.lcm_url);
    if (key) bus.set_key(*key);
    log_start(world.scenario(), bus, options.real_time);
    Runner runner(world, bus, options.wait_s, csv.is_open() ? &csv : nullptr,
                  {options.publish_intent, static_cast<std::size_t>(options.threads), options.driven_by_base});
    summarise(options.real_time ? runner.play_in_real_time() : runner.play_in_lockstep(), world);
  } catch (const bus::BusError& error) {
    return fail(kUnavailable, error.what());
  } catch (const NoAnswer& error) {
    return fail(kSoftware, error.what());
  }
  if (csv.is_open() && !csv.flush()) return fail(kUnavailable, "could not write all of " + options.record_path);
  return kOk;
}

/// The program, from its command line to its exit code.
int program(int argc, char** argv) {
  fill_missing_standard_streams();
  const ParsedSimOptions parsed = parse_sim_options(argc, argv);
  if (parsed.exit_code) return *parsed.exit_code;
  catch_stop_signals();
  spdlog::set_default_logger(spdlog::stderr_color_mt("pilotfish-sim"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  try {
    return run(parsed.options);
  } catch (const ConfigError& error) {
    return fail(kConfig, std::string("bad scenario: ") + error.what());
  } catch (const std::exception& error) {
    return fail(kSoftware, error.what());
  }
}

}  // namespace
}  // namespace pilotfish::apps

int main(int argc, char** argv) {
  using namespace pilotfish::apps;
  return guarded("pilotfish-sim", [argc, argv] { return program(argc, argv); });
}
