#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

#include "pilotfish/config/fuzzy_text.hpp"
#include "pilotfish/core/parameter.hpp"

namespace pilotfish::config {
namespace {

using fuzzy::Controller;
using fuzzy::LinguisticVariable;

// The fewest digits that read as the same double.
std::string digits(double x) {
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), x).ptr};
}

std::string yaml_number(double x) { return std::isinf(x) ? (x < 0.0 ? "-.inf" : ".inf") : digits(x); }

struct Shape {
  std::string name;
  std::vector<double> numbers;
};

Shape shape_of(const fuzzy::MembershipFunction& set) {
  if (const auto* s = std::get_if<fuzzy::Triangle>(&set)) return {"Triangle", {s->a, s->b, s->c}};
  if (const auto* s = std::get_if<fuzzy::Trapezoid>(&set)) return {"Trapezoid", {s->a, s->b, s->c, s->d}};
  const auto& gaussian = std::get<fuzzy::Gaussian>(set);
  return {"Gaussian", {gaussian.mean, gaussian.sigma}};
}

const std::string& identifier(const std::string& name) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '.'; };
  if (name.empty() || !std::all_of(name.begin(), name.end(), fits))
    throw ConfigError(name, "is not a name in FLL: letters, digits, '_' and '.' only");
  return name;
}

std::string fll_variable(const std::string& kind, const LinguisticVariable& variable) {
  std::string text = kind + ": " + identifier(variable.name) + "\n  enabled: true\n  range: " + digits(variable.min) +
                     " " + digits(variable.max) + "\n  lock-range: true\n";
  if (kind == "OutputVariable")
    text += "  aggregation: Maximum\n  defuzzifier: Centroid 1000\n  default: nan\n  lock-previous: false\n";
  for (const fuzzy::Term& term : variable.terms) {
    const Shape shape = shape_of(term.set);
    text += "  term: " + identifier(term.label) + " " + shape.name;
    for (double number : shape.numbers) text += " " + digits(number);
    text += "\n";
  }
  return text;
}

void emit_set(YAML::Emitter& yaml, const fuzzy::MembershipFunction& set) {
  Shape shape = shape_of(set);
  shape.name[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(shape.name[0])));
  yaml << YAML::Flow << YAML::BeginMap << YAML::Key << shape.name << YAML::Value;
  if (std::holds_alternative<fuzzy::Gaussian>(set)) {
    yaml << YAML::Flow << YAML::BeginMap << YAML::Key << "mean" << YAML::Value << yaml_number(shape.numbers[0])
         << YAML::Key << "sigma" << YAML::Value << yaml_number(shape.numbers[1]) << YAML::EndMap;
  } else {
    yaml << YAML::Flow << YAML::BeginSeq;
    for (double number : shape.numbers) yaml << yaml_number(number);
    yaml << YAML::EndSeq;
  }
  yaml << YAML::EndMap;
}

void emit_variable(YAML::Emitter& yaml, const char* key, const LinguisticVariable& variable) {
  yaml << YAML::Key << key << YAML::Value << YAML::BeginMap;
  yaml << YAML::Key << "universe" << YAML::Value << YAML::Flow << YAML::BeginSeq << yaml_number(variable.min)
       << yaml_number(variable.max) << YAML::EndSeq;
  yaml << YAML::Key << "terms" << YAML::Value << YAML::BeginMap;
  for (const fuzzy::Term& term : variable.terms) {
    yaml << YAML::Key << term.label << YAML::Value;
    emit_set(yaml, term.set);
  }
  yaml << YAML::EndMap << YAML::EndMap;
}

void emit_row(YAML::Emitter& yaml, const std::string& key, const std::vector<std::string>& cells) {
  yaml << YAML::Key << key << YAML::Value << YAML::Flow << cells;
}

}  // namespace

std::string to_fll(const Controller& controller) {
  std::string text = "Engine: " + controller.name + "\n";
  text += fll_variable("InputVariable", controller.error);
  text += fll_variable("InputVariable", controller.error_change);
  text += fll_variable("OutputVariable", controller.output);
  text +=
      "RuleBlock: table\n  enabled: true\n  conjunction: Minimum\n  disjunction: none\n  implication: Minimum\n"
      "  activation: General\n";
  for (std::size_t row = 0; row < controller.rules.rows; ++row)
    for (std::size_t column = 0; column < controller.rules.columns; ++column)
      text += "  rule: if " + controller.error.name + " is " + controller.error.terms[row].label + " and " +
              controller.error_change.name + " is " + controller.error_change.terms[column].label + " then " +
              controller.output.name + " is " +
              controller.output.terms[controller.rules.consequent(row, column)].label + "\n";
  return text;
}

std::string to_yaml(const Controller& controller) {
  YAML::Emitter yaml;
  yaml << YAML::BeginMap << YAML::Key << "name" << YAML::Value << controller.name;
  emit_variable(yaml, "E", controller.error);
  emit_variable(yaml, "EC", controller.error_change);
  emit_variable(yaml, "U", controller.output);
  yaml << YAML::Key << "rules" << YAML::Value << YAML::BeginMap;
  std::vector<std::string> cells;
  for (const fuzzy::Term& column : controller.error_change.terms) cells.push_back(column.label);
  emit_row(yaml, "columns", cells);
  for (std::size_t row = 0; row < controller.rules.rows; ++row) {
    for (std::size_t column = 0; column < controller.rules.columns; ++column)
      cells[column] = controller.output.terms[controller.rules.consequent(row, column)].label;
    emit_row(yaml, controller.error.terms[row].label, cells);
  }
  yaml << YAML::EndMap << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

}  // namespace pilotfish::config
