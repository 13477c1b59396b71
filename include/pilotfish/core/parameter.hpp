#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
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

/// Three numbers of one kind, as a configuration writes them: [1, 2, 3].
using Vector3 = std::array<double, 3>;

/// The one description of a parameter: its key (which carries the unit), where it lives, its bounds and its text. The
/// default is the struct's own member initialiser. From it come the YAML reader, the range check, the documentation,
/// the JSON schema and the Python binding, so none of them can drift.
///
/// A config struct has a table `static const std::vector<Parameter<T>>& parameters()`; the macros below make it.
template <class Config>
struct Parameter {
  /// A field of the struct.
  using Member =
      std::variant<double Config::*, int Config::*, bool Config::*, std::string Config::*, Vector3 Config::*>;
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

/// "7 is outside [0, 5]" of a number that is, or is not finite; nothing of one within its bounds, both inclusive.
template <class Number>
std::optional<std::string> outside(Number value, Number min, Number max) {
  if (std::isfinite(static_cast<double>(value)) && value >= min && value <= max) return std::nullopt;
  std::ostringstream problem;
  problem << value << " is outside [" << min << ", " << max << "]";
  return problem.str();
}

/// Throws ConfigError naming the key, the value and the allowed range, if the number is out of range or not finite.
template <class Config>
void check_range(const Config& config, const Parameter<Config>& parameter, std::string_view section) {
  const auto check_number = [&](double value) {
    if (const auto problem = outside(value, parameter.min, parameter.max))
      throw ConfigError(dotted(section, parameter.key), *problem);
  };
  std::visit(
      [&](auto member) {
        using Value = std::decay_t<decltype(config.*member)>;
        if constexpr (std::is_same_v<Value, Vector3>) {
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

namespace parameter_detail {

/// Identifies a parameter of a struct by the line it stands in.
template <int Line>
struct At {};

/// The most lines that PILOTFISH_PARAMETERS looks through for parameters.
inline constexpr int kLines = 64;

template <class Config, int... Line>
std::vector<Parameter<Config>> collect(std::integer_sequence<int, Line...>) {
  std::vector<Parameter<Config>> table;
  (Config::add_parameter(table, At<Config::kFirstLine + Line>{}), ...);
  return table;
}

template <class Config>
const std::vector<Parameter<Config>>& table() {
  static const std::vector<Parameter<Config>> made = collect<Config>(std::make_integer_sequence<int, kLines>{});
  return made;
}

}  // namespace parameter_detail

/// Before the first parameter of a struct: its table parameters(), of the parameters in the lines below.
///
///     struct WheelConfig {
///       PILOTFISH_PARAMETERS(WheelConfig);
///       PILOTFISH_PARAMETER(double, radius_m, 0.05, 0.01, 0.5, "as it rolls under load");
///       PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, driven, true, "false: it only measures");
///     };
///
/// is `double radius_m = 0.05; bool driven = true;` and their rows in the table, in this order.
#define PILOTFISH_PARAMETERS(Config)                                                                                  \
  using DescribedConfig = Config; /* a type takes no parentheses: NOLINTNEXTLINE(bugprone-macro-parentheses) */       \
  static const std::vector<::pilotfish::Parameter<Config>>& parameters() {                                            \
    return ::pilotfish::parameter_detail::table<Config>();                                                            \
  }                                                                                                                   \
  template <int Line> /* a line without a parameter; a type: NOLINTNEXTLINE(bugprone-macro-parentheses) */            \
  static void add_parameter(std::vector<::pilotfish::Parameter<Config>>&, ::pilotfish::parameter_detail::At<Line>) {} \
  static constexpr int kFirstLine = __LINE__

/// A member that is a parameter: double, int or Vector3; the default, the least and the greatest value allowed, and one
/// sentence for the documentation.
#define PILOTFISH_PARAMETER(type, name, initial, min, max, text)                                                      \
  static_assert(__LINE__ - kFirstLine < ::pilotfish::parameter_detail::kLines, "too far below PILOTFISH_PARAMETERS"); \
  static void add_parameter(std::vector<::pilotfish::Parameter<DescribedConfig>>& table,                              \
                            ::pilotfish::parameter_detail::At<__LINE__>) {                                            \
    table.push_back({#name, &DescribedConfig::name, min, max, text});                                                 \
  }                                                                                                                   \
  type name = initial

/// The same of a bool or a text.
#define PILOTFISH_PARAMETER_WITHOUT_RANGE(type, name, initial, text) \
  PILOTFISH_PARAMETER(type, name, initial, 0.0, 0.0, text)

}  // namespace pilotfish
PILOTFISH_API_END
