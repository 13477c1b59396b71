#pragma once

#include <array>
#include <ostream>
#include <sstream>
#include <string>
#include <variant>

#include "pilotfish/core/parameter.hpp"

// A table of parameters as rows of Markdown.
namespace pilotfish::config {

template <class Value>
std::string shown(const Value& value) {
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

template <class Value>
std::string range(double min, double max) {
  if constexpr (std::is_same_v<Value, bool>) return "true, false";
  if constexpr (std::is_same_v<Value, std::string>) return "text";
  return shown(min) + " to " + shown(max);
}

template <class Config>
void describe(std::ostream& out) {
  const Config defaults;
  for (const Parameter<Config>& parameter : Config::parameters()) {
    std::visit(
        [&](auto member) {
          using Value = std::decay_t<decltype(defaults.*member)>;
          out << "| `" << parameter.key << "` | " << shown(defaults.*member) << " | "
              << range<Value>(parameter.min, parameter.max) << " | " << parameter.text << " |\n";
        },
        parameter.member);
  }
}

template <class... Config>
void describe_section(std::ostream& out, const char* section) {
  out << "\n## `" << section << "`\n\n| key | default | range | meaning |\n|---|---|---|---|\n";
  (describe<Config>(out), ...);
}

}  // namespace pilotfish::config
