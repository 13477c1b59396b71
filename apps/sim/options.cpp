#include "options.hpp"

#include <CLI/CLI.hpp>
#include <limits>
#include <sstream>

#include "exit_codes.hpp"
#include "pilotfish/core/number.hpp"
#include "usage_errors.hpp"
#include "version.hpp"

namespace pilotfish::apps {
namespace {

constexpr const char* kExamples = R"(
Examples
  pilotfish-sim --scenario line --record line.csv
      as fast as the coordinators answer, the same run every time; in another terminal, before or after:
      pilotfish-coordinator --config data/config/line.yaml --simulated-time
  pilotfish-sim --scenario circle --realtime
      at the pace of the clock, to watch with pilotfish-spy or lcm-logger
  pilotfish-sim --scenario data/scenarios/star.yaml --lcm-url 'udpm://239.255.76.67:7700?ttl=0'
      on a bus of its own: another port, which the coordinators need too
  pilotfish-sim --scenario line --realtime --drive-by base
      the wheels execute the commands of pilotfish-base --driver simulator, between them and the coordinator

Every robot's true pose goes out on NAME_POSE, every camera's pictures on NAME_IMAGE, with --publish-intent every leader's
twist on NAME_MOTION; each robot that follows another is driven by what comes in on NAME_COMMAND. A setpoint in the
scenario is sent on NAME_SETPOINT until the coordinator's NAME_STATUS shows it; then comes the first picture.

Ends with 0 when the scenario is over or on SIGINT/SIGTERM, 64 on a wrong command line, 69 if the bus or the recording
cannot be opened, 70 if a coordinator does not answer, 78 on a bad scenario or key (the message says which).)";

/// CLI11's own ranges let NaN pass, and write out their bounds with 309 digits.
template <class Value>
CLI::Validator within(Value min, Value max) {
  std::ostringstream range;
  range << min << " to " << max;
  const auto refuse = [min, max, text = range.str()](const std::string& given) {
    const auto value = number_from<Value>(given);
    return value && *value >= min && *value <= max ? std::string() : "'" + given + "' is not a number from " + text;
  };
  return {refuse, range.str()};
}

constexpr double kLongest_s = 1e5;  // as Scenario::duration_s

}  // namespace

ParsedSimOptions parse_sim_options(int argc, char** argv) {
  SimOptions options;
  bool lockstep = false;
  std::string driven_by = "coordinator";
  CLI::App app{"A world of robots with rendered cameras, as a process on the LCM bus.", "pilotfish-sim"};
  app.footer(kExamples);
  app.set_version_flag("--version", std::string("pilotfish-sim ") + kVersion, "print the version and end");
  app.add_option("--scenario", options.scenario_path,
                 "what to play: a file, or the name of a shipped one: line, circle, star, ...")
      ->required();
  app.add_option("--lcm-url", options.lcm_url, "LCM bus. Default: $LCM_DEFAULT_URL, else this host alone");
  auto* real_time = app.add_flag("--realtime", options.real_time,
                                 "pictures at the pace of the clock, delivered after the camera's latency");
  app.add_flag("--lockstep", lockstep, "wait for the answer to each picture: repeatable bit for bit (the default)")
      ->excludes(real_time);
  app.add_flag("--publish-intent", options.publish_intent,
               "robots that others follow say on NAME_MOTION how they move");
  app.add_option("--drive-by", driven_by,
                 "source of the wheels' commands: the coordinator (NAME_COMMAND), or pilotfish-base --driver simulator "
                 "(NAME_BASE)")
      ->check(CLI::IsMember({"coordinator", "base"}))
      ->capture_default_str();
  app.add_option("--key", options.key_path,
                 "file with the coordinators' key (their key_file), if they have one; made by pilotfish key new");
  app.add_option("--record", options.record_path,
                 "CSV file for the truth and the commands, one row per robot and frame");
  app.add_option("--duration-s", options.duration_s, "instead of the scenario's")->check(within(0.0, kLongest_s));
  app.add_option("--seed", options.seed, "of noise, clutter and dropped frames, instead of the scenario's")
      ->check(within(0, std::numeric_limits<int>::max()));
  app.add_option("--threads", options.threads,
                 "that render pictures, one of them each; the pictures are the same, whatever the number")
      ->check(within(1, 256))
      ->capture_default_str();
  app.add_option("--wait-s", options.wait_s, "how long to wait for the first answer of every coordinator")
      ->check(within(0.01, kLongest_s))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
    options.driven_by_base = driven_by == "base";
    if (options.driven_by_base && !options.real_time)
      throw CLI::ValidationError("--drive-by base", "needs --realtime: a base answers to the clock, not to pictures");
  } catch (const CLI::ParseError& error) {
    return {options, answer_usage(app, error)};
  }
  return {options, std::nullopt};
}

}  // namespace pilotfish::apps
