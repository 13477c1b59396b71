#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotfish/core/parameter.hpp"
#include "pilotfish/fuzzy/linguistic_variable.hpp"

namespace pilotfish::config {

/// "  range: -1.000 1.000", and where it stands.
struct FllLine {
  std::string file;
  int number = 0;
  std::string key, value;
};

/// An Engine, InputVariable, OutputVariable or RuleBlock: its heading and the lines below it.
struct FllBlock {
  FllLine heading;
  std::vector<FllLine> lines;
};

/// Without comments and blank lines. Throws ConfigError for a line that is not of the form  key: value.
std::vector<FllBlock> fll_blocks(const std::string& text, const std::filesystem::path& file);

std::vector<std::string> fll_words(const std::string& text);

/// A word of the line; inf and nan pass. Throws ConfigError.
double fll_number(const FllLine& line, const std::string& word);

/// "NB Triangle -1.0 -0.5 0.0". Throws ConfigError for shapes and heights that this law does not have.
fuzzy::Term fll_term(const FllLine& line);

/// ConfigError with the line as its key and the file behind the problem.
ConfigError fll_error(const FllLine& line, const std::string& problem);

}  // namespace pilotfish::config
