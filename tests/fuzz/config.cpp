// Every YAML file of ours: the same text as a configuration of either program, a tuning, a leader, a controller and a
// scenario. Each is loaded or refused with ConfigError; anything else that is thrown ends the program.
#include <cstdint>

#include "pilotfish/config/base_file.hpp"
#include "pilotfish/config/files.hpp"
#include "pilotfish/config/scenario_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pilotfish;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const config::TextFile file{PILOTFISH_DATA "/config/fuzzed.yaml", text};  // what it names is found from there
  const auto loads = [](const auto& parse) {
    try {
      parse();
    } catch (const ConfigError&) {  // refused, as it should be
    }
  };
  loads([&] { config::parse_coordinator(file); });
  loads([&] { config::parse_base(file); });
  loads([&] { config::parse_leader_body(file); });
  loads([&] { config::parse_fuzzy_controller(file); });
  loads([&] { config::parse_scenario(file); });
  loads([&] {
    control::FollowerConfig control;
    config::parse_tuning(file, control);
  });
  return 0;
}
