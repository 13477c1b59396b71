#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace pilotfish::config {

/// A channel is made of the robot's name, so it must be one word.
inline bool is_name(const std::string& name) {
  const auto is_word_letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  return !name.empty() && name.size() <= 32 && std::all_of(name.begin(), name.end(), is_word_letter);
}
inline std::string not_a_name(const std::string& name) {
  return "'" + name + "' is not a name; use 1 to 32 letters, digits and underscores";
}

}  // namespace pilotfish::config
