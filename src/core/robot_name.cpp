#include "pilotfish/core/robot_name.hpp"

#include <algorithm>
#include <cctype>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish {

void check_robot_name(const std::string& name, const std::string& key) {
  const auto is_word_letter = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  if (!name.empty() && name.size() <= 32 && std::all_of(name.begin(), name.end(), is_word_letter)) return;
  std::string shown = name;
  std::replace(shown.begin(), shown.end(), '\0', '?');  // a zero is where what() ends
  throw ConfigError(key, "'" + shown + "' is not a name; use 1 to 32 letters, digits and underscores");
}

std::string channel_word(const std::string& robot) {
  std::string word = robot;
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::toupper(c); });
  return word;
}

}  // namespace pilotfish
