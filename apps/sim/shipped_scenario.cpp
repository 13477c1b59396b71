#include "shipped_scenario.hpp"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish::apps {
namespace fs = std::filesystem;

namespace {

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

bool is_name(const std::string& asked) {
  return !asked.empty() && asked.find('/') == std::string::npos && asked.find('.') == std::string::npos;
}

std::string names_in(const std::vector<fs::path>& data_folders) {
  std::vector<std::string> names;
  for (const fs::path& folder : data_folders)
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "scenarios"))
      if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "no shipped scenario was found; set PILOTFISH_DATA to the folder that has `scenarios`"
                      : "shipped are " + text;
}

}  // namespace

std::vector<fs::path> data_folders(const fs::path& program_folder) {
  std::vector<fs::path> folders;
  const auto consider = [&](const fs::path& folder) {
    if (is_folder(folder / "scenarios")) folders.push_back(folder);
  };
  if (const char* given = std::getenv("PILOTFISH_DATA"); given != nullptr && *given != '\0') consider(given);
  consider(program_folder / "../share/pilotfish/data");
  std::error_code ignored;
  for (const fs::directory_entry& python : fs::directory_iterator(program_folder / "../lib", ignored))
    consider(python.path() / "site-packages/pilotfish/data");
  consider(program_folder / "../python/pilotfish/data");
  consider(program_folder / "../../../data");
  return folders;
}

std::string scenario_file(const std::string& asked, const std::vector<fs::path>& data_folders) {
  std::error_code ignored;
  if (!is_name(asked) || fs::exists(asked, ignored)) return asked;
  for (const fs::path& folder : data_folders) {
    const fs::path file = folder / "scenarios" / (asked + ".yaml");
    if (fs::exists(file, ignored)) return file.lexically_normal();
  }
  throw ConfigError("--scenario",
                    "'" + asked + "' is neither a file nor a shipped scenario; " + names_in(data_folders));
}

fs::path program_folder() {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  return program.empty() ? fs::path(".") : program.parent_path();
}

}  // namespace pilotfish::apps
