#pragma once

#include <filesystem>

#include "pilotfish/api.hpp"
#include "pilotfish/config/text_file.hpp"
#include "pilotfish/sim/scenario.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::config {

/// A scenario for the simulator; see data/scenarios/ and docs. Files it names (calibration, leader,
/// coordinator) are relative to it; the first two are read, the coordinator's is not.
/// Throws ConfigError.
sim::Scenario load_scenario(const std::filesystem::path& file);
sim::Scenario parse_scenario(const TextFile& file);

}  // namespace pilotfish::config
PILOTFISH_API_END
