#include "fll_lines.hpp"

#include <set>
#include <sstream>

#include "pilotfish/core/number.hpp"

namespace pilotfish::config {
namespace {

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

}  // namespace

std::vector<FllBlock> fll_blocks(const std::string& text, const std::filesystem::path& file) {
  static const std::set<std::string> headings = {"Engine", "InputVariable", "OutputVariable", "RuleBlock"};
  std::vector<FllBlock> result;
  std::istringstream stream(text);
  int number = 0;
  for (std::string raw; std::getline(stream, raw);) {
    ++number;
    const std::string content = trimmed(raw.substr(0, raw.find('#')));
    if (content.empty()) continue;
    const auto colon = content.find(':');
    const FllLine line{file.string(), number, trimmed(content.substr(0, colon)),
                       colon == std::string::npos ? "" : trimmed(content.substr(colon + 1))};
    if (colon == std::string::npos) throw fll_error(line, "'" + content + "' is not of the form  key: value");
    if (headings.count(line.key) != 0) {
      result.push_back({line, {}});
    } else if (result.empty()) {
      throw fll_error(line, "'" + line.key + "' stands before any Engine, InputVariable, OutputVariable or RuleBlock");
    } else {
      result.back().lines.push_back(line);
    }
  }
  return result;
}

std::vector<std::string> fll_words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

double fll_number(const FllLine& line, const std::string& word) {
  if (const auto value = number_from<double>(word)) return *value;
  throw fll_error(line, "'" + word + "' is not a number");
}

ConfigError fll_error(const FllLine& line, const std::string& problem) {
  return {"line " + std::to_string(line.number), problem + " (in " + line.file + ")"};
}

}  // namespace pilotfish::config
