// A controller in fuzzylite's language is refused with ConfigError, or validated, and can then be written and read
// again.
#include <cstdint>

#include "pilotfish/config/files.hpp"
#include "pilotfish/config/fuzzy_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pilotfish;
  std::string again;
  try {
    again = config::to_fll(
        config::parse_fuzzy_controller({"fuzzed.fll", std::string(reinterpret_cast<const char*>(data), size)}));
  } catch (const ConfigError&) {
    return 0;  // refused, as it should be
  }
  config::parse_fuzzy_controller({"again.fll", again});
  return 0;
}
