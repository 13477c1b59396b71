#pragma once

#include <optional>
#include <string>

#include "config_options.hpp"

namespace pilotfish::apps {

/// Where frames come from: the part before and after the first colon of --source.
struct SourceSpec {
  enum class Kind { camera, video, images, lcm, log } kind = Kind::lcm;
  std::string argument;
};
/// Throws std::invalid_argument that lists the choices.
SourceSpec parse_source(const std::string& text);

struct Options : ConfigOptions {
  std::optional<std::string> source;
  std::optional<std::string> law;
  std::optional<std::string> profile;
  std::optional<std::string> tuning;
  std::optional<std::string> odometry;
  std::optional<std::string> leader_intent_from;
  bool publish_intent = false;
  std::optional<std::string> black_box;
  std::optional<std::string> record;
  bool record_raw = false;
  bool quiet = false;
  std::string command_line;  ///< as it was given
  std::string lcm_url;
  bool simulated_time = false;
  bool live = false;
  bool json = false;
};

/// The options, or the exit code with which to end at once (after --help, or a usage error already printed).
struct ParsedOptions {
  Options options;
  std::optional<int> exit_code;
};
ParsedOptions parse_options(int argc, char** argv);

}  // namespace pilotfish::apps
