#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <thread>

namespace pilotfish::apps {

struct SimOptions {
  std::string scenario_path;
  std::string lcm_url;
  std::string record_path;
  std::string key_path;
  bool real_time = false;
  bool publish_intent = false;
  bool driven_by_base = false;
  std::optional<double> duration_s;
  std::optional<int> seed;
  double wait_s = 10.0;
  int threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 256U));  ///< one a processor
};

/// The options, or the exit code with which to end at once (after --help, or a usage error already printed).
struct ParsedSimOptions {
  SimOptions options;
  std::optional<int> exit_code;
};
ParsedSimOptions parse_sim_options(int argc, char** argv);

}  // namespace pilotfish::apps
