// Every YAML file of ours: the first byte says what the rest is, a configuration of either program, a tuning, a leader,
// a controller or a scenario. It is loaded or refused with ConfigError; anything else that is thrown ends the program.
#include <cstdint>

#include "pilotfish/config/base_file.hpp"
#include "pilotfish/config/files.hpp"
#include "pilotfish/config/scenario_file.hpp"

namespace {

void load(unsigned kind, const pilotfish::config::TextFile& file) {
  using namespace pilotfish;
  switch (kind) {
    case 0: config::parse_coordinator(file); break;
    case 1: config::parse_base(file); break;
    case 2: config::parse_leader_body(file); break;
    case 3: config::parse_fuzzy_controller(file); break;
    case 4: config::parse_scenario(file); break;
    default: {
      control::FollowerConfig control;
      config::parse_tuning(file, control);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {  // what the file names is found from the shipped ones
    load(data[0] % 6U, {PILOTFISH_DATA "/config/fuzzed.yaml", text});
  } catch (const pilotfish::ConfigError&) {  // refused, as it should be
  }
  return 0;
}
