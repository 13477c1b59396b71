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

/// The errors of a non-ideal robot, as data/hardware/nonideal.yaml: its sections `drive` and `camera` count in place of
/// what the scenario says of each robot that follows another. Throws ConfigError.
void apply_hardware(const TextFile& file, sim::Scenario& scenario);

}  // namespace pilotfish::config
PILOTFISH_API_END
