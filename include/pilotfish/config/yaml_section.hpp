#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/config/text_file.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/sections.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::config {

/// The YAML in a text. Throws ConfigError with `key` if there is none or more than one
/// document, or if it is nested without end.
YAML::Node parse_yaml(const std::string& text, const std::string& key, const std::filesystem::path& path);

/// One mapping of a YAML file, read strictly: a missing required key, a key of the wrong type, a value out of range and
/// an unknown key are all ConfigError with the dotted key. Angles `x_rad` may be written `x_deg`.
class YamlSection {
 public:
  /// Throws ConfigError with the key that named the file if it is not a mapping.
  static YamlSection parse(const TextFile& file);

  /// `path`: the section's dotted key; `file`: for messages.
  YamlSection(const YAML::Node& node, std::string path, std::filesystem::path file);

  /// An angle `x_rad` may be given as `x_deg`: use has_angle("x_rad").
  bool has(const std::string& key) const;
  std::vector<std::string> keys() const;  ///< the existing ones, in the file's order, for mappings with names as keys
  /// has(key), and key is known from now on: finish() lists it and accepts it.
  bool optional(const std::string& key);
  /// Whether the key is there, in radians or in degrees.
  bool has_angle(const std::string& key_rad) const { return has(key_rad) || has(degrees_key(key_rad)); }
  /// A number within bounds; throws ConfigError.
  double number(const std::string& key, double min, double max);
  double angle(const std::string& key_rad, double min_rad, double max_rad);  ///< key_rad ends in _rad; _deg accepted
  /// A whole number within bounds; throws ConfigError.
  int integer(const std::string& key, int min, int max);
  bool boolean(const std::string& key);                       ///< true or false; throws ConfigError
  std::string text(const std::string& key);                   ///< throws ConfigError if it is none
  std::vector<double> numbers(const std::string& key);        ///< a list of numbers of any length; inf and NaN pass
  std::filesystem::path file_path(const std::string& key);    ///< relative to the file this section was read from
  TextFile file(const std::string& key);                      ///< the content of the file named there
  std::vector<std::string> texts(const std::string& key);     ///< a list of texts of any length
  YamlSection section(const std::string& key);                ///< a nested mapping
  std::vector<YamlSection> sections(const std::string& key);  ///< a list of mappings

  /// Every parameter of the table that is present; defaults stay for the others. Range-checked.
  template <class Config>
  void read(Config& config) {
    for (const Parameter<Config>& parameter : Config::parameters()) {
      const std::string key(parameter.key);
      asked_.insert(key);  // so that finish() can list every key there is
      if (!has_angle(key)) continue;
      std::visit(
          [&](auto member) {
            using Value = std::decay_t<decltype(config.*member)>;
            if constexpr (std::is_same_v<Value, double>) {
              config.*member =
                  is_angle(key) ? angle(key, parameter.min, parameter.max) : number(key, parameter.min, parameter.max);
            } else if constexpr (std::is_same_v<Value, int>) {
              config.*member = integer(key, static_cast<int>(parameter.min), static_cast<int>(parameter.max));
            } else if constexpr (std::is_same_v<Value, bool>) {
              config.*member = boolean(key);
            } else if constexpr (std::is_same_v<Value, std::string>) {
              config.*member = text(key);
            } else {
              config.*member = vector3(key, parameter.min, parameter.max);
            }
          },
          parameter.member);
    }
  }

  /// read() of the whole tree (core/sections.hpp): a section that is not there leaves its defaults. Does not check for
  /// unknown keys in this section itself: finish() does.
  template <class Config>
  void read_tree(Config& config) {
    if constexpr (kHasParameters<Config>) read(config);
    if constexpr (kHasSections<Config>)
      Config::sections([&](const std::string& name, auto member) {
        if (name.empty()) {
          read_tree(config.*member);
        } else {
          read_section(name, config.*member);
        }
      });
  }
  /// read_tree() of a section, if it is there, and nothing else in it.
  template <class Config>
  void read_section(const std::string& name, Config& config) {
    if (!optional(name)) return;
    YamlSection part = section(name);
    part.read_tree(config);
    part.finish();
  }

  /// Call when done: throws ConfigError naming the first unknown key, with the keys that exist.
  void finish() const;

  /// What `make` returns. A ConfigError that does not name this file is thrown on with its name.
  template <class Make>
  auto naming_file(Make&& make) const {
    try {
      return std::forward<Make>(make)();
    } catch (const ConfigError& error) {
      const std::string said = error.what();
      if (said.find(file_.string()) != std::string::npos) throw;
      throw ConfigError(error.key(), said.substr(error.key().size() + 2) + " (in " + file_.string() + ")");
    }
  }
  /// For errors that only the caller can detect: ConfigError with this section's path before the key.
  ConfigError error(const std::string& key, const std::string& problem) const;
  const std::filesystem::path& file() const { return file_; }  ///< from which it was read

 private:
  static bool is_angle(const std::string& key);
  static std::string degrees_key(const std::string& key);  ///< "x_rad" -> "x_deg"; empty if not an angle
  Vector3 vector3(const std::string& key, double min, double max);
  YAML::Node require(const std::string& key);
  std::string dotted(const std::string& key) const;

  YAML::Node node_;
  std::string path_;
  std::filesystem::path file_;
  std::set<std::string> asked_;
};

}  // namespace pilotfish::config
PILOTFISH_API_END
