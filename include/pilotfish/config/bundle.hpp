#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/config/files.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::config {

/// What the command line overrides in the configuration, as far as the core is affected.
struct ConfigOverrides {
  /// Names; empty: as configured.
  std::optional<std::string> law, profile, tuning;  ///< tuning: a file
};
/// Throws ConfigError; also if the tuning is for another law than the active one.
void apply(const ConfigOverrides& overrides, control::FollowerConfig& config);
void apply(const ConfigOverrides& overrides, CoordinatorFile& file);

/// A file that a coordinator was configured with.
struct ConfigText {
  std::string role;  ///< the key that names the file: config, camera.calibration, leader, fuzzy, tuning; --tuning
  std::string name;  ///< where it was
  std::string text;  ///< its text
};

/// Everything a coordinator is configured with, as texts: from it the same coordinator can be made anywhere.
struct ConfigBundle {
  std::vector<ConfigText> files;  ///< list of ConfigText, a copy
  ConfigOverrides overrides;      ///< ConfigOverrides of the command line
};

/// Of a configuration that load_coordinator() takes. Throws ConfigError.
ConfigBundle bundle_config(const std::filesystem::path& file, const ConfigOverrides& overrides);
/// The result that load_coordinator() and apply() gave then. Writes the texts into a temporary folder, under names of
/// its own, and removes it. Throws ConfigError.
CoordinatorFile load_bundle(const ConfigBundle& bundle);

}  // namespace pilotfish::config
PILOTFISH_API_END
