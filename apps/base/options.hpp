#pragma once

#include <optional>
#include <string>

#include "config_options.hpp"

namespace pilotfish::apps {

struct BaseOptions : ConfigOptions {
  std::optional<std::string> driver;
  std::string lcm_url;
  bool quiet = false;
};

/// The options, or the exit code with which to end at once (after --help, or a usage error already printed).
struct ParsedBaseOptions {
  BaseOptions options;
  std::optional<int> exit_code;
};
ParsedBaseOptions parse_base_options(int argc, char** argv);

}  // namespace pilotfish::apps
