#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pilotfish::apps {

/// Where the shipped data can be, nearest first: $PILOTFISH_DATA, and places relative to the folder of the program: of
/// a package, a wheel, a checkout's build folder. Those that exist.
std::vector<std::filesystem::path> data_folders(const std::filesystem::path& program_folder);

/// The file to play. `asked` is a path, or the name of a shipped scenario ("line"), where no such file exists. Throws
/// ConfigError, key `--scenario`, listing the names.
std::string scenario_file(const std::string& asked, const std::vector<std::filesystem::path>& data_folders);

/// The folder of the program that runs.
std::filesystem::path program_folder();

}  // namespace pilotfish::apps
