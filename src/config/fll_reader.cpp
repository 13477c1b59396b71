#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "fll_lines.hpp"
#include "pilotfish/config/fuzzy_text.hpp"
#include "pilotfish/core/parameter.hpp"

namespace pilotfish::config {
namespace {

using fuzzy::Controller;
using fuzzy::LinguisticVariable;

// Outside the range a term must be what it is at its end; otherwise saturating would change the controller.
void check_saturation(const FllLine& lock_range, const LinguisticVariable& variable) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
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
      throw fll_error(lock_range, "lock-range is false, but term '" + term.label + "' of " + variable.name +
                                      " changes outside the range, where inputs saturate here; say lock-range: true");
  }
}

LinguisticVariable read_variable(const FllBlock& block) {
  const bool is_input = block.heading.key == "InputVariable";
  LinguisticVariable variable;
  variable.name = block.heading.value;
  bool ranged = false, aggregated = false, defuzzified = false;
  FllLine lock_range = block.heading;
  lock_range.value = "false";
  for (const FllLine& line : block.lines) {
    const std::vector<std::string> words = fll_words(line.value);
    const std::string first = words.empty() ? "" : words[0];
    const auto only = [&](const std::string& wanted) {
      if (first != wanted) throw fll_error(line, line.key + " '" + line.value + "' is not supported; only " + wanted);
      return true;
    };
    if (line.key == "range") {
      if (words.size() != 2) throw fll_error(line, "range needs two numbers, got '" + line.value + "'");
      variable.min = fll_number(line, words[0]);
      variable.max = fll_number(line, words[1]);
      ranged = true;
    } else if (line.key == "term") {
      variable.terms.push_back(fll_term(line));
    } else if (line.key == "enabled") {
      only("true");
    } else if (line.key == "lock-range") {
      lock_range = line;
    } else if (!is_input && line.key == "aggregation") {
      aggregated = only("Maximum");
    } else if (!is_input && line.key == "defuzzifier") {
      defuzzified = only("Centroid");
    } else if (line.key != "description" && (is_input || (line.key != "default" && line.key != "lock-previous"))) {
      throw fll_error(line, "'" + line.key + "' is not a key of " + block.heading.key);
    }
  }
  if (!ranged) throw fll_error(block.heading, variable.name + " has no range");
  if (!is_input && !aggregated) throw fll_error(block.heading, variable.name + " needs  aggregation: Maximum");
  if (!is_input && !defuzzified) throw fll_error(block.heading, variable.name + " needs  defuzzifier: Centroid");
  fuzzy::validate(variable);
  if (is_input && lock_range.value != "true") check_saturation(lock_range, variable);
  return variable;
}

// if E is NB and EC is NB then U is PB [with 1.0]
void read_rules(const FllBlock& block, Controller& controller) {
  const LinguisticVariable &e = controller.error, &ec = controller.error_change, &u = controller.output;
  const std::size_t rows = e.terms.size(), columns = ec.terms.size();
  std::vector<std::optional<std::size_t>> cells(rows * columns);
  bool conjunction = false, implication = false;
  for (const FllLine& line : block.lines) {
    const auto only = [&](const std::string& wanted) {
      if (line.value != wanted)
        throw fll_error(line, line.key + " '" + line.value + "' is not supported; only " + wanted);
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
      std::vector<std::string> w = fll_words(line.value);
      if (w.size() == 14 && w[12] == "with" && fll_number(line, w[13]) == 1.0) w.resize(12);
      const bool sentence = w.size() == 12 && w[0] == "if" && w[2] == "is" && w[4] == "and" && w[6] == "is" &&
                            w[8] == "then" && w[10] == "is" && w[9] == u.name;
      const bool in_order = sentence && w[1] == e.name && w[5] == ec.name;
      const bool turned = sentence && w[1] == ec.name && w[5] == e.name;
      if (!in_order && !turned)
        throw fll_error(line, "'" + line.value + "' is not of the form  if " + e.name + " is ... and " + ec.name +
                                  " is ... then " + u.name + " is ...  (no hedges, no `or`, no weights)");
      try {
        const std::size_t row = e.index_of(in_order ? w[3] : w[7]), column = ec.index_of(in_order ? w[7] : w[3]);
        std::optional<std::size_t>& cell = cells[row * columns + column];
        if (cell)
          throw fll_error(line, "there is already a rule for " + e.name + " " + e.terms[row].label + " and " + ec.name +
                                    " " + ec.terms[column].label);
        cell = u.index_of(w[11]);
      } catch (const ConfigError&) {
        throw;
      } catch (const std::invalid_argument& problem) {
        throw fll_error(line, problem.what());
      }
    } else if (line.key != "description" && line.key != "disjunction") {  // without `or` disjunction is never used
      throw fll_error(line, "'" + line.key + "' is not a key of RuleBlock");
    }
  }
  if (!conjunction) throw fll_error(block.heading, "the rule block needs  conjunction: Minimum");
  if (!implication) throw fll_error(block.heading, "the rule block needs  implication: Minimum");
  controller.rules = {rows, columns, {}};
  for (std::size_t rule = 0; rule < cells.size(); ++rule) {
    if (!cells[rule])
      throw fll_error(block.heading, "there is no rule for " + e.name + " " + e.terms[rule / columns].label + " and " +
                                         ec.name + " " + ec.terms[rule % columns].label);
    controller.rules.consequents.push_back(*cells[rule]);
  }
}

}  // namespace

Controller read_fll(const std::string& text, const std::filesystem::path& file, const std::string& key) {
  const auto missing = [&](const std::string& what) { return ConfigError(key, what + " (in " + file.string() + ")"); };
  Controller controller;
  std::vector<LinguisticVariable*> inputs = {&controller.error_change, &controller.error};  // the next one is last
  std::vector<LinguisticVariable*> outputs = {&controller.output};
  const FllBlock* rule_block = nullptr;
  const std::vector<FllBlock> blocks = fll_blocks(text, file);
  for (const FllBlock& block : blocks) {
    const std::string& kind = block.heading.key;
    try {
      if (kind == "Engine") {
        controller.name = block.heading.value;
        for (const FllLine& line : block.lines)
          if (line.key != "description") throw fll_error(line, "'" + line.key + "' is not a key of Engine");
      } else if (kind == "RuleBlock") {
        if (rule_block != nullptr) throw fll_error(block.heading, "more than one RuleBlock is not supported");
        rule_block = &block;
      } else {
        auto& wanted = kind == "InputVariable" ? inputs : outputs;
        if (wanted.empty())
          throw fll_error(block.heading, "more than " + std::string(kind == "InputVariable" ? "two" : "one") + " " +
                                             kind + " is not supported");
        *wanted.back() = read_variable(block);
        wanted.pop_back();
      }
    } catch (const fuzzy::ValidationError& defect) {
      throw ConfigError(defect.where(), defect.problem() + " (in " + file.string() + ")");
    }
  }
  if (!inputs.empty()) throw missing("two InputVariables are needed, the error and its change");
  if (!outputs.empty()) throw missing("an OutputVariable is needed");
  if (rule_block == nullptr) throw missing("a RuleBlock is needed");
  read_rules(*rule_block, controller);
  return controller;
}

}  // namespace pilotfish::config
