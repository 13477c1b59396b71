#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include "pilotfish/config/fuzzy_text.hpp"
#include "pilotfish/core/parameter.hpp"

namespace pilotfish::config {
namespace {

using fuzzy::Controller;
using fuzzy::LinguisticVariable;
using fuzzy::MembershipFunction;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// "  range: -1.000 1.000"
struct Line {
  int number = 0;
  std::string key, value;
};
/// An Engine, InputVariable, OutputVariable or RuleBlock: its heading and the lines below it.
struct Block {
  Line heading;
  std::vector<Line> lines;
};

struct Reader {
  std::filesystem::path file;

  ConfigError error(const Line& line, const std::string& problem) const {
    return {"line " + std::to_string(line.number), problem + " (in " + file.string() + ")"};
  }
  ConfigError error(const std::string& problem) const { return {"file", problem + " (in " + file.string() + ")"}; }

  std::vector<Block> blocks(const std::string& text) const;
  double number(const Line& line, const std::string& word) const;
  MembershipFunction set(const Line& line, const std::string& label, const std::vector<std::string>& words) const;
  fuzzy::Term term(const Line& line) const;
  LinguisticVariable variable(const Block& block) const;
  void rules(const Block& block, Controller& controller) const;
  void check_saturation(const Line& lock_range, const LinguisticVariable& variable) const;
};

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::vector<Block> Reader::blocks(const std::string& text) const {
  static const std::set<std::string> headings = {"Engine", "InputVariable", "OutputVariable", "RuleBlock"};
  std::vector<Block> result;
  std::istringstream stream(text);
  int number = 0;
  for (std::string raw; std::getline(stream, raw);) {
    ++number;
    const std::string content = trimmed(raw.substr(0, raw.find('#')));
    if (content.empty()) continue;
    const auto colon = content.find(':');
    const Line line{number, trimmed(content.substr(0, colon)),
                    colon == std::string::npos ? "" : trimmed(content.substr(colon + 1))};
    if (colon == std::string::npos) throw error(line, "'" + content + "' is not of the form  key: value");
    if (headings.count(line.key) != 0) {
      result.push_back({line, {}});
    } else if (result.empty()) {
      throw error(line, "'" + line.key + "' stands before any Engine, InputVariable, OutputVariable or RuleBlock");
    } else {
      result.back().lines.push_back(line);
    }
  }
  return result;
}

double Reader::number(const Line& line, const std::string& word) const {
  const bool plus = !word.empty() && word[0] == '+';  // from_chars knows no plus
  double value = 0.0;
  const auto [end, problem] = std::from_chars(word.data() + (plus ? 1 : 0), word.data() + word.size(), value);
  if (problem != std::errc() || end != word.data() + word.size()) throw error(line, "'" + word + "' is not a number");
  return value;
}

// What the words after a term's label say. Where fuzzylite has an open end (a corner at infinity), both corners of that
// side are at infinity here.
MembershipFunction Reader::set(const Line& line, const std::string& label,
                               const std::vector<std::string>& words) const {
  const std::string& shape = words[1];
  const auto parameters = [&](std::size_t count) {
    std::vector<double> n;
    for (std::size_t i = 2; i < words.size(); ++i) n.push_back(number(line, words[i]));
    if (n.size() == count + 1 && n.back() != 1.0)
      throw error(line, "term '" + label + "': height " + words.back() + " is not supported; only 1");
    if (n.size() != count && n.size() != count + 1)
      throw error(line, "term '" + label + "': " + shape + " needs " + std::to_string(count) + " numbers, got " +
                            std::to_string(n.size()));
    return n;
  };
  const auto trapezoid = [](double a, double b, double c, double d) -> MembershipFunction {
    return fuzzy::Trapezoid{a, a == -kInfinity ? -kInfinity : b, d == kInfinity ? kInfinity : c, d};
  };
  if (shape == "Triangle") {
    const auto n = parameters(3);
    if (std::isinf(n[0]) || std::isinf(n[2])) return trapezoid(n[0], n[1], n[1], n[2]);
    return fuzzy::Triangle{n[0], n[1], n[2]};
  }
  if (shape == "Trapezoid") {
    const auto n = parameters(4);
    return trapezoid(n[0], n[1], n[2], n[3]);
  }
  if (shape == "Ramp") {  // 0 at the first number, 1 at the second and beyond it
    const auto n = parameters(2);
    return n[0] < n[1] ? trapezoid(n[0], n[1], kInfinity, kInfinity) : trapezoid(-kInfinity, -kInfinity, n[1], n[0]);
  }
  if (shape == "Rectangle") {
    const auto n = parameters(2);
    return trapezoid(n[0], n[0], n[1], n[1]);
  }
  if (shape == "Binary") {  // 1 from the start on, in the direction of the second number
    const auto n = parameters(2);
    return n[1] > n[0] ? trapezoid(n[0], n[0], kInfinity, kInfinity) : trapezoid(-kInfinity, -kInfinity, n[0], n[0]);
  }
  if (shape == "Gaussian") {
    const auto n = parameters(2);
    return fuzzy::Gaussian{n[0], n[1]};
  }
  throw error(line, "term '" + label + "': " + shape +
                        " is not supported; Triangle, Trapezoid, Ramp, Rectangle, Binary and Gaussian are");
}

fuzzy::Term Reader::term(const Line& line) const {
  const std::vector<std::string> words = words_of(line.value);
  if (words.size() < 2) throw error(line, "a term needs a name and a shape, got '" + line.value + "'");
  fuzzy::Term result{words[0], set(line, words[0], words)};
  try {
    fuzzy::validate(result.set);
  } catch (const std::invalid_argument& problem) {
    throw error(line, "term '" + words[0] + "': " + problem.what());
  }
  return result;
}

// Outside the range a term must be what it is at its end; otherwise saturating would change the controller.
void Reader::check_saturation(const Line& lock_range, const LinguisticVariable& variable) const {
  for (const fuzzy::Term& term : variable.terms) {
    const bool constant = [&] {
      if (std::holds_alternative<fuzzy::Gaussian>(term.set)) return false;
      const auto [left, right] = fuzzy::support(term.set);
      const auto [core_left, core_right] = fuzzy::level_cut(term.set, 1.0);
      const auto same = [&](double end, double beyond) {
        return fuzzy::membership(term.set, end) == fuzzy::membership(term.set, beyond);
      };
      for (double corner : {left, core_left, core_right, right})
        if (std::isfinite(corner) && (corner < variable.min || corner > variable.max)) return false;
      return same(variable.min, -kInfinity) && same(variable.max, kInfinity);
    }();
    if (!constant)
      throw error(lock_range, "lock-range is false, but term '" + term.label + "' of " + variable.name +
                                  " changes outside the range, where inputs saturate here; say lock-range: true");
  }
}

LinguisticVariable Reader::variable(const Block& block) const {
  const bool is_input = block.heading.key == "InputVariable";
  LinguisticVariable variable;
  variable.name = block.heading.value;
  bool ranged = false, aggregated = false, defuzzified = false;
  Line lock_range = block.heading;
  lock_range.value = "false";
  for (const Line& line : block.lines) {
    const std::vector<std::string> words = words_of(line.value);
    const std::string first = words.empty() ? "" : words[0];
    const auto only = [&](const std::string& wanted) {
      if (first != wanted) throw error(line, line.key + " '" + line.value + "' is not supported; only " + wanted);
      return true;
    };
    if (line.key == "range") {
      if (words.size() != 2) throw error(line, "range needs two numbers, got '" + line.value + "'");
      variable.min = number(line, words[0]);
      variable.max = number(line, words[1]);
      ranged = true;
    } else if (line.key == "term") {
      variable.terms.push_back(term(line));
    } else if (line.key == "enabled") {
      only("true");
    } else if (line.key == "lock-range") {
      lock_range = line;
    } else if (!is_input && line.key == "aggregation") {
      aggregated = only("Maximum");
    } else if (!is_input && line.key == "defuzzifier") {
      defuzzified = only("Centroid");
    } else if (line.key != "description" && (is_input || (line.key != "default" && line.key != "lock-previous"))) {
      throw error(line, "'" + line.key + "' is not a key of " + block.heading.key);
    }
  }
  if (!ranged) throw error(block.heading, variable.name + " has no range");
  if (!is_input && !aggregated) throw error(block.heading, variable.name + " needs  aggregation: Maximum");
  if (!is_input && !defuzzified) throw error(block.heading, variable.name + " needs  defuzzifier: Centroid");
  fuzzy::validate(variable);
  if (is_input && lock_range.value != "true") check_saturation(lock_range, variable);
  return variable;
}

// if E is NB and EC is NB then U is PB [with 1.0]
void Reader::rules(const Block& block, Controller& controller) const {
  const LinguisticVariable &e = controller.error, &ec = controller.error_change, &u = controller.output;
  const std::size_t rows = e.terms.size(), columns = ec.terms.size();
  std::vector<std::optional<std::size_t>> cells(rows * columns);
  bool conjunction = false, implication = false;
  for (const Line& line : block.lines) {
    const auto only = [&](const std::string& wanted) {
      if (line.value != wanted) throw error(line, line.key + " '" + line.value + "' is not supported; only " + wanted);
      return true;
    };
    if (line.key == "conjunction") {
      conjunction = only("Minimum");
    } else if (line.key == "implication") {
      implication = only("Minimum");
    } else if (line.key == "activation") {
      only("General");
    } else if (line.key == "enabled") {
      only("true");
    } else if (line.key == "rule") {
      std::vector<std::string> w = words_of(line.value);
      if (w.size() == 14 && w[12] == "with" && number(line, w[13]) == 1.0) w.resize(12);
      const bool sentence = w.size() == 12 && w[0] == "if" && w[2] == "is" && w[4] == "and" && w[6] == "is" &&
                            w[8] == "then" && w[10] == "is" && w[9] == u.name;
      const bool in_order = sentence && w[1] == e.name && w[5] == ec.name;
      const bool turned = sentence && w[1] == ec.name && w[5] == e.name;
      if (!in_order && !turned)
        throw error(line, "'" + line.value + "' is not of the form  if " + e.name + " is ... and " + ec.name +
                              " is ... then " + u.name + " is ...  (no hedges, no `or`, no weights)");
      try {
        const std::size_t row = e.index_of(in_order ? w[3] : w[7]), column = ec.index_of(in_order ? w[7] : w[3]);
        std::optional<std::size_t>& cell = cells[row * columns + column];
        if (cell)
          throw error(line, "there is already a rule for " + e.name + " " + e.terms[row].label + " and " + ec.name +
                                " " + ec.terms[column].label);
        cell = u.index_of(w[11]);
      } catch (const ConfigError&) {
        throw;
      } catch (const std::invalid_argument& problem) {
        throw error(line, problem.what());
      }
    } else if (line.key != "description" && line.key != "disjunction") {  // without `or` disjunction is never asked
      throw error(line, "'" + line.key + "' is not a key of RuleBlock");
    }
  }
  if (!conjunction) throw error(block.heading, "the rule block needs  conjunction: Minimum");
  if (!implication) throw error(block.heading, "the rule block needs  implication: Minimum");
  controller.rules = {rows, columns, {}};
  for (std::size_t rule = 0; rule < cells.size(); ++rule) {
    if (!cells[rule])
      throw error(block.heading, "there is no rule for " + e.name + " " + e.terms[rule / columns].label + " and " +
                                     ec.name + " " + ec.terms[rule % columns].label);
    controller.rules.consequents.push_back(*cells[rule]);
  }
}

}  // namespace

Controller read_fll(const std::string& text, const std::filesystem::path& file) {
  const Reader reader{file};
  Controller controller;
  std::vector<LinguisticVariable*> inputs = {&controller.error_change, &controller.error};  // the next one is last
  std::vector<LinguisticVariable*> outputs = {&controller.output};
  const Block* rule_block = nullptr;
  const std::vector<Block> blocks = reader.blocks(text);
  for (const Block& block : blocks) {
    const std::string& kind = block.heading.key;
    try {
      if (kind == "Engine") {
        controller.name = block.heading.value;
        for (const Line& line : block.lines)
          if (line.key != "description") throw reader.error(line, "'" + line.key + "' is not a key of Engine");
      } else if (kind == "RuleBlock") {
        if (rule_block != nullptr) throw reader.error(block.heading, "more than one RuleBlock is not supported");
        rule_block = &block;
      } else {
        auto& wanted = kind == "InputVariable" ? inputs : outputs;
        if (wanted.empty())
          throw reader.error(block.heading, "more than " + std::string(kind == "InputVariable" ? "two" : "one") + " " +
                                                kind + " is not supported");
        *wanted.back() = reader.variable(block);
        wanted.pop_back();
      }
    } catch (const fuzzy::ProofError& defect) {
      throw ConfigError(defect.where(), defect.problem() + " (in " + file.string() + ")");
    }
  }
  if (!inputs.empty()) throw reader.error("two InputVariables are needed, the error and its change");
  if (!outputs.empty()) throw reader.error("an OutputVariable is needed");
  if (rule_block == nullptr) throw reader.error("a RuleBlock is needed");
  reader.rules(*rule_block, controller);
  return controller;
}

}  // namespace pilotfish::config
