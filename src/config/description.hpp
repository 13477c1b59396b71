#pragma once

#include <array>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "pilotfish/control/law.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/sections.hpp"

// What a configuration file may hold, as data: made from the tables that read and check it, printed as Markdown for
// people and as JSON schema for editors.
namespace pilotfish::config {

struct KeyDescription {
  enum class Type { number, integer, boolean, text, vector3 };
  std::string key;
  Type type = Type::text;
  std::string fallback;  ///< the default as YAML; empty: an empty text, or the key is required
  double min = 0.0, max = 0.0;
  std::string text;
  bool required = false;
  std::vector<std::string> choices;  ///< of a text; empty: any
};

struct SectionDescription {
  std::string path;  ///< dotted; empty: the top level
  std::string text;  ///< a line before the table
  std::vector<KeyDescription> keys;
};

using ConfigDescription = std::vector<SectionDescription>;

/// A key of a file's top level that no table holds: a text, with its choices if there are only some.
inline KeyDescription text_key(std::string key, std::string fallback, std::string text,
                               std::vector<std::string> choices = {}) {
  return {std::move(key), KeyDescription::Type::text, std::move(fallback), 0.0, 0.0, std::move(text),
          false,          std::move(choices)};
}
inline KeyDescription required_key(std::string key, std::string text) {
  return {std::move(key), KeyDescription::Type::text, "", 0.0, 0.0, std::move(text), true, {}};
}

template <class Value>
std::string as_yaml(const Value& value) {
  std::ostringstream out;
  if constexpr (std::is_same_v<Value, bool>) {
    out << (value ? "true" : "false");
  } else if constexpr (std::is_same_v<Value, std::array<double, 3>>) {
    out << "[" << value[0] << ", " << value[1] << ", " << value[2] << "]";
  } else {
    out << value;
  }
  return out.str();
}

template <class Config>
KeyDescription describe_key(const Parameter<Config>& parameter, const Config& defaults) {
  using Type = KeyDescription::Type;
  KeyDescription key{std::string(parameter.key),  Type::number, "", parameter.min, parameter.max,
                     std::string(parameter.text), false,        {}};
  std::visit(
      [&](auto member) {
        using Value = std::decay_t<decltype(defaults.*member)>;
        key.fallback = as_yaml(defaults.*member);
        if constexpr (std::is_same_v<Value, int>) key.type = Type::integer;
        if constexpr (std::is_same_v<Value, bool>) key.type = Type::boolean;
        if constexpr (std::is_same_v<Value, std::string>) key.type = Type::text;
        if constexpr (std::is_same_v<Value, std::array<double, 3>>) key.type = Type::vector3;
      },
      parameter.member);
  return key;
}

template <class Config>
void describe_keys(std::vector<KeyDescription>& keys, const Config& defaults) {
  if constexpr (kHasParameters<Config>)
    for (const Parameter<Config>& parameter : Config::parameters()) keys.push_back(describe_key(parameter, defaults));
  if constexpr (kHasSections<Config>)
    Config::sections([&](std::string_view name, auto member) {
      if (name.empty()) describe_keys(keys, defaults.*member);
    });
}

/// The section `path` and every one below it.
template <class Config>
void describe_tree(ConfigDescription& description, const std::string& path, const Config& defaults) {
  SectionDescription section{path, "", {}};
  describe_keys(section.keys, defaults);
  if (!section.keys.empty()) description.push_back(std::move(section));
  if constexpr (kHasSections<Config>)
    Config::sections([&](std::string_view name, auto member) {
      if (!name.empty()) describe_tree(description, dotted(path, name), defaults.*member);
    });
}

void describe_law(ConfigDescription& description, const control::LawDescription& law);

/// The sections as tables under headings, without a title.
std::string as_markdown(const ConfigDescription& description);
/// A JSON schema (draft 2020-12) of the whole file. Angles may be written in degrees, as the reader takes them.
std::string as_json_schema(const std::string& title, const ConfigDescription& description);

}  // namespace pilotfish::config
