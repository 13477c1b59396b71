#pragma once

#include <optional>
#include <string>

namespace pilotfish::apps {

struct BaseOptions {
  std::string config_path;
  std::optional<std::string> name;
  std::optional<std::string> driver;
  std::string lcm_url;
  bool quiet = false;
  std::string describe_config;  ///< how to print it: markdown, json; empty: not at all
};

/// The options, or the exit code with which to end at once (after --help, or a usage error already printed).
struct ParsedBaseOptions {
  BaseOptions options;
  std::optional<int> exit_code;
};
ParsedBaseOptions parse_base_options(int argc, char** argv);

}  // namespace pilotfish::apps
