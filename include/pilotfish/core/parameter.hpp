#pragma once

#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// A value that cannot be used, found while loading. `key` is the dotted path of the parameter ("vision.decimation").
class ConfigError : public std::invalid_argument {
 public:
  /// `key`: dotted, as in the file.
  ConfigError(std::string key, const std::string& problem)
      : std::invalid_argument(key + ": " + problem), key_(std::move(key)) {}
  const std::string& key() const { return key_; }  ///< the key at fault, dotted

 private:
  std::string key_;
};

/// The one description of a parameter: its key (which carries the unit), where it lives, its bounds and its text. The
/// default is the struct's own member initialiser. From this table come the YAML reader, the range check, the
/// documentation, the JSON schema and the Python binding, so none of them can drift.
///
/// A config struct declares  `static const std::vector<Parameter<T>>& parameters();`
template <class Config>
struct Parameter {
  /// A field of the struct.
  using Member = std::variant<double Config::*, int Config::*, bool Config::*, std::string Config::*,
                              std::array<double, 3> Config::*>;
  std::string_view key;   ///< e.g. "max_linear_mps"; a key ending in _rad may be written as _deg in YAML
  Member member;          ///< where the value is
  double min = 0.0;       ///< inclusive; numbers (and each component of a vector) only
  double max = 0.0;       ///< inclusive
  std::string_view text;  ///< one sentence for the documentation and --help
};

/// "limits" and "max_linear_mps": "limits.max_linear_mps".
inline std::string dotted(std::string_view section, std::string_view key) {
  return section.empty() ? std::string(key) : std::string(section) + "." + std::string(key);
}

/// Throws ConfigError naming the key, the value and the allowed range, if the number is out of range or not finite.
template <class Config>
void check_range(const Config& config, const Parameter<Config>& parameter, std::string_view section) {
  const auto check_number = [&](double value) {
    if (std::isfinite(value) && value >= parameter.min && value <= parameter.max) return;
    std::ostringstream problem;
    problem << value << " is outside [" << parameter.min << ", " << parameter.max << "]";
    throw ConfigError(dotted(section, parameter.key), problem.str());
  };
  std::visit(
      [&](auto member) {
        using Value = std::decay_t<decltype(config.*member)>;
        if constexpr (std::is_same_v<Value, std::array<double, 3>>) {
          for (double component : config.*member) check_number(component);
        } else if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, int>) {
          check_number(config.*member);
        }
      },
      parameter.member);
}

/// The same of every parameter of the table.
template <class Config>
void check_ranges(const Config& config, std::string_view section) {
  for (const Parameter<Config>& parameter : Config::parameters()) check_range(config, parameter, section);
}

}  // namespace pilotfish
PILOTFISH_API_END
