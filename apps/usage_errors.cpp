#include "usage_errors.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

#include "exit_codes.hpp"

namespace pilotfish::apps {
namespace {

/// Levenshtein: the least number of letters to insert, remove or replace.
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

/// "; did you mean --source?" of an option that is nearly one, or nothing.
std::string nearest_option(const CLI::App& app, const std::string& word) {
  constexpr std::size_t kSlips = 2;
  const std::string name = word.substr(0, word.find('='));
  std::string nearest;
  std::size_t fewest = kSlips + 1;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& known : option->get_lnames())
      if (const std::size_t edits = edits_between(name, "--" + known); edits < fewest) {
        fewest = edits;
        nearest = "; did you mean --" + known + "?";
      }
  return nearest;
}

bool is_a_file_of(const CLI::App& app, const std::string& word, const char* option) {
  const auto ends_in = [&](const std::string& end) {
    return word.size() > end.size() && word.compare(word.size() - end.size(), end.size(), end) == 0;
  };
  return app.get_option_no_throw(option) != nullptr && (ends_in(".yaml") || ends_in(".yml"));
}

std::string unexpected(const CLI::App& app) {
  std::vector<std::string> words = app.remaining();
  // An unknown option's value comes with it, and is not at fault.
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string& word) { return word[0] == '-'; });
  const std::string& word = option != words.end() ? *option : words.front();
  if (option != words.end()) return word + " is not an option" + nearest_option(app, word);
  for (const char* takes_a_file : {"--config", "--scenario"})
    if (is_a_file_of(app, word, takes_a_file)) return "'" + word + "' needs " + takes_a_file + " in front of it";
  return "'" + word + "' is not expected here";
}

}  // namespace

int answer_usage(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);
  const bool extra = !app.remaining().empty();  // also where something else is missing, such as its --config
  std::cerr << app.get_name() << ": " << (extra ? unexpected(app) : error.what()) << "\n"
            << "Options and examples: " << app.get_name() << " --help\n";
  return kUsage;
}

}  // namespace pilotfish::apps
