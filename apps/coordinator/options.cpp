#include "options.hpp"

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "exit_codes.hpp"
#include "pilotfish/control/follower.hpp"
#include "usage_errors.hpp"
#include "version.hpp"

namespace pilotfish::apps {
namespace {

constexpr const char* kSources =
    "camera:N (the Nth camera), video:FILE, images:DIR, lcm[:CHANNEL] (NAME_IMAGE if no channel is given) or log:FILE "
    "(written by lcm-logger)";

constexpr const char* kExamples = R"(
Examples
  pilotfish-coordinator --config coordinator.yaml --source camera:0
      drive, looking through the first camera
  pilotfish-coordinator --config coordinator.yaml --source images:run1 --json
      what it would have done on a folder of pictures: one JSON object per frame, nothing on the network
  pilotfish-coordinator --config line.yaml
      wait for images on ROBOT1_IMAGE, as a camera's program or pilotfish-sim --realtime publishes them
  pilotfish-coordinator --config line.yaml --simulated-time
      the same for pilotfish-sim in lock-step

Ends with 0 when the source ends or on SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1/2 (after sending zero commands), 64 on a
wrong command line, 69 if the source or the bus cannot be opened or another coordinator has this name, 70 if it failed
inside (zeros first), 78 on a bad configuration (the message names the key).
The keys of the configuration: pilotfish-coordinator --describe-config)";

}  // namespace

SourceSpec parse_source(const std::string& text) {
  using Kind = SourceSpec::Kind;
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  const std::string argument = colon == std::string::npos ? "" : text.substr(colon + 1);
  if (text == "lcm") return {Kind::lcm, ""};
  for (auto [name, value] :
       {std::pair{"camera", Kind::camera}, std::pair{"video", Kind::video}, std::pair{"images", Kind::images},
        std::pair{"log", Kind::log}, std::pair{"lcm", Kind::lcm}}) {
    if (kind != name) continue;
    if (argument.empty()) throw std::invalid_argument("'" + text + "' lacks the part after the colon; use " + kSources);
    if (value == Kind::camera && (argument.size() > 3 || argument.find_first_not_of("0123456789") != std::string::npos))
      throw std::invalid_argument("'" + argument + "' is not a camera's number, as in camera:0");
    return {value, argument};
  }
  throw std::invalid_argument("'" + text + "' is not a source; use " + kSources);
}

ParsedOptions parse_options(int argc, char** argv) {
  Options options;
  for (int i = 0; i < argc; ++i) options.command_line += (i == 0 ? "" : " ") + std::string(argv[i]);
  CLI::App app{"Follows a leader robot by sight: sees its AprilTags, keeps distance and bearing, commands over LCM.",
               "pilotfish-coordinator"};
  app.footer(kExamples);
  app.set_version_flag("--version", std::string("pilotfish-coordinator ") + kVersion, "print the version and end");
  add_config_options(app, options, "data/config/coordinator.yaml");
  app.add_option("--source", options.source, std::string("where frames come from: ") + kSources);
  app.add_option(
      "--lcm-url", options.lcm_url,
      "LCM bus; memq:// keeps everything inside this process. Default: $LCM_DEFAULT_URL, else this host alone");
  app.add_option("--law", options.law, "the law that drives: fuzzy, or a baseline to compare it with")
      ->check(CLI::IsMember(control::law_names(control::FollowerConfig{})));
  app.add_option("--profile", options.profile, "how the fuzzy law drives: as published, or around a feed-forward")
      ->check(CLI::IsMember({"paper", "anticipate"}));
  app.add_option("--tuning", options.tuning,
                 "parameters of the law, as pilotfish tune writes them; they override the configuration");
  app.add_option("--odometry", options.odometry, "where the own twist is measured: nowhere, or on NAME_POSE")
      ->check(CLI::IsMember({"none", "pose"}));
  app.add_option("--leader-intent-from", options.leader_intent_from,
                 "the leader's name on the bus, to receive what it announces on its NAME_MOTION; none: disabled");
  app.add_flag("--publish-intent", options.publish_intent,
               "what it is about to drive is announced on its NAME_MOTION, for robots that follow it");
  app.add_option("--black-box", options.black_box,
                 "folder for a ring of recordings, from which pilotfish replay recomputes every command");
  auto* record = app.add_option("--record", options.record,
                                "the same with every picture that comes from the camera or the bus, as JPEG");
  app.add_flag("--record-raw", options.record_raw,
               "pictures that come raw are recorded raw, so that pilotfish replay --from-pixels can repeat the vision")
      ->needs(record);
  app.add_flag("--quiet", options.quiet,
               "log warnings only; without it a summary is logged every 2 s, and every change of the status");
  app.add_flag(
      "--simulated-time", options.simulated_time,
      "time passes as the images' stamps say, for pilotfish-sim in lock-step: real wheels ignore such commands");
  app.add_flag("--live", options.live,
               "with files (video:, images:, log:), publish on the bus; otherwise nothing leaves this process");
  app.add_flag("--json", options.json, "print one JSON object per frame on stdout (and the log on stderr)");
  try {
    app.parse(argc, argv);
    if (options.source) parse_source(*options.source);
  } catch (const CLI::ParseError& error) {
    return {options, answer_usage(app, error)};
  } catch (const std::invalid_argument& error) {
    std::cerr << app.get_name() << ": --source: " << error.what() << "\n";
    return {options, kUsage};
  }
  return {options, std::nullopt};
}

}  // namespace pilotfish::apps
