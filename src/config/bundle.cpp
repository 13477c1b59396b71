#include "pilotfish/config/bundle.hpp"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "pilotfish/config/yaml_section.hpp"

namespace pilotfish::config {
namespace {

constexpr std::array<const char*, 4> kFileKeys = {"camera.calibration", "leader", "fuzzy", "tuning"};
constexpr const char* kConfig = "config";
constexpr const char* kTuningOption = "--tuning";

constexpr const char* kAlternatives = "alternatives.leaders";

/// The value of a dotted key, with [0], [1], ... for the elements of a list; an undefined node if it is not there.
YAML::Node node_at(const YAML::Node& root, const std::string& key) {
  const std::size_t end = key.find_first_of(".[");
  const YAML::Node first = root[key.substr(0, end)];
  if (end == std::string::npos || !first.IsDefined()) return first;
  if (key[end] == '.') return first.IsMap() ? node_at(first, key.substr(end + 1)) : first;
  const YAML::Node element = first[std::stoul(key.substr(end + 1))];
  return element.IsMap() ? node_at(element, key.substr(key.find(']') + 2)) : element;
}

/// The keys whose values are files, of this configuration.
std::vector<std::string> file_keys(const YAML::Node& root) {
  std::vector<std::string> keys(kFileKeys.begin(), kFileKeys.end());
  const YAML::Node others = node_at(root, kAlternatives);
  if (others.IsDefined() && others.IsSequence())
    for (std::size_t i = 0; i < others.size(); ++i)
      keys.push_back(kAlternatives + ("[" + std::to_string(i) + "]") + ".leader");
  return keys;
}

YAML::Node parsed(const std::string& text, const std::string& name, const std::string& key = "file") {
  YAML::Node root = parse_yaml(text, key, name);
  if (!root.IsMap()) throw ConfigError(key, name + " is not a YAML mapping (key: value)");
  return root;
}

/// A section of `control` that the law does not read would be tuned for nothing: most likely the file is another
/// law's.
void check_tuning_is_used(const YAML::Node& tuning, const control::FollowerConfig& config) {
  for (const auto& entry : tuning) {
    const std::string section = entry.first.as<std::string>();
    if (control::uses_section(config, section)) continue;
    const bool fuzzy = config.active_law == control::kFuzzyLaw;
    throw ConfigError(kTuningOption, "'" + section + "' has no effect on " + (fuzzy ? "profile " : "law ") +
                                         (fuzzy ? std::string(to_string(config.profile)) : config.active_law) +
                                         "; choose the --law or --profile that the file is for, or another file");
  }
}

/// A folder that is gone when this is.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "pilotfish-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw ConfigError("file", "cannot make a temporary folder " + name);
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream stream(path_ / name, std::ios::binary);
    stream << text;
    if (!stream.flush()) throw ConfigError("file", "cannot write " + (path_ / name).string());
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// The readers recognise FLL by its name's end; nothing else of the old name is used.
std::string local_name(std::size_t index, const ConfigText& file) {
  return std::to_string(index) + (std::filesystem::path(file.name).extension() == ".fll" ? ".fll" : ".txt");
}

}  // namespace

void apply(const ConfigOverrides& overrides, control::FollowerConfig& config) {
  if (overrides.law) control::set_active_law(config, *overrides.law);
  if (overrides.profile) config.profile = control::profile_from(*overrides.profile);
  if (!overrides.tuning) return;
  const TextFile file = read_text_file(*overrides.tuning, kTuningOption);
  parse_tuning(file, config);
  check_tuning_is_used(parsed(file.text, *overrides.tuning, kTuningOption), config);
}

void apply(const ConfigOverrides& overrides, CoordinatorFile& file) { apply(overrides, file.coordinator.control); }

ConfigBundle bundle_config(const std::filesystem::path& file, const ConfigOverrides& overrides) {
  ConfigBundle bundle{{{kConfig, file.string(), read_text_file(file).text}}, overrides};
  const YAML::Node root = parsed(bundle.files.front().text, file.string());
  for (const std::string& key : file_keys(root)) {
    const YAML::Node node = node_at(root, key);
    if (!node.IsDefined() || !node.IsScalar()) continue;
    const std::filesystem::path path = file.parent_path() / node.Scalar();  // an absolute one stays as it is
    bundle.files.push_back({key, path.string(), read_text_file(path, key).text});
  }
  if (overrides.tuning)
    bundle.files.push_back({kTuningOption, *overrides.tuning, read_text_file(*overrides.tuning, kTuningOption).text});
  return bundle;
}

CoordinatorFile load_bundle(const ConfigBundle& bundle) {
  const TemporaryFolder folder;
  ConfigOverrides overrides = bundle.overrides;
  overrides.tuning.reset();
  YAML::Node root;
  for (const ConfigText& file : bundle.files)  // first, whatever the order: the others take their place in it
    if (file.role == kConfig) root = parsed(file.text, file.name);
  for (std::size_t i = 0; i < bundle.files.size(); ++i) {
    const ConfigText& file = bundle.files[i];
    if (file.role == kConfig) continue;
    const std::string name = local_name(i, file);
    const std::filesystem::path path = folder.write(name, file.text);
    if (file.role == kTuningOption) {
      overrides.tuning = path.string();
    } else if (YAML::Node node = node_at(root, file.role); node.IsDefined()) {
      node = name;
    }
  }
  if (!root.IsMap()) throw ConfigError("file", "the recording has no configuration");
  // A file that was not recorded must not be looked for on this computer.
  for (const std::string& key : file_keys(root))
    if (YAML::Node node = node_at(root, key); node.IsDefined() && node.IsScalar()) {
      bool recorded = false;
      for (const ConfigText& file : bundle.files) recorded = recorded || file.role == key;
      if (!recorded) throw ConfigError(key, "the recording lacks the file '" + node.Scalar() + "'");
    }
  YAML::Emitter text;
  text << root;  // scalars keep their text, so numbers keep their bits
  CoordinatorFile file = load_coordinator(folder.write("config.yaml", text.c_str()));
  apply(overrides, file);
  return file;
}

}  // namespace pilotfish::config
