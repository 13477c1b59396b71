#include <limits>

#include "pilotfish/config/files.hpp"
#include "pilotfish/config/fuzzy_text.hpp"
#include "pilotfish/config/yaml_section.hpp"

namespace pilotfish::config {
namespace {

using fuzzy::Controller;
using fuzzy::LinguisticVariable;
using fuzzy::MembershipFunction;

// One of  triangle: [a, b, c],  trapezoid: [a, b, c, d],  gaussian: {mean: m, sigma: s}.
MembershipFunction read_set(YamlSection& set) {
  const auto corners = [&](const std::string& shape, std::size_t count) {
    std::vector<double> numbers = set.numbers(shape);
    if (numbers.size() != count)
      throw set.error(shape, "needs " + std::to_string(count) + " numbers, got " + std::to_string(numbers.size()));
    return numbers;
  };
  if (set.has("triangle")) {
    const auto n = corners("triangle", 3);
    return fuzzy::Triangle{n[0], n[1], n[2]};
  }
  if (set.has("trapezoid")) {
    const auto n = corners("trapezoid", 4);
    return fuzzy::Trapezoid{n[0], n[1], n[2], n[3]};
  }
  if (!set.has("gaussian")) throw set.error("shape", "is missing: one of triangle, trapezoid, gaussian");
  YamlSection section = set.section("gaussian");
  constexpr double kAny = std::numeric_limits<double>::max();
  const fuzzy::Gaussian gaussian{section.number("mean", -kAny, kAny), section.number("sigma", 0.0, kAny)};
  section.finish();
  return gaussian;
}

// A universe and its terms. Their order in the file is their order on the axis, from negative to positive.
LinguisticVariable read_variable(YamlSection& file, const std::string& name) {
  YamlSection section = file.section(name);
  LinguisticVariable variable;
  variable.name = name;
  const std::vector<double> universe = section.numbers("universe");
  if (universe.size() != 2) throw section.error("universe", "needs two numbers, [min, max]");
  variable.min = universe[0];
  variable.max = universe[1];
  YamlSection terms = section.section("terms");
  for (const std::string& label : terms.keys()) {
    YamlSection set = terms.section(label);
    variable.terms.push_back({label, read_set(set)});
    set.finish();
  }
  terms.finish();
  section.finish();
  return variable;
}

// The table as it is printed: `columns` names the terms of EC, then comes one row for each term of E.
void read_rules(YamlSection& file, Controller& controller) {
  YamlSection section = file.section("rules");
  const auto& rows = controller.error.terms;
  const auto& columns = controller.error_change.terms;

  const std::vector<std::string> headings = section.texts("columns");
  std::vector<std::string> expected;
  std::string expected_text;
  for (const fuzzy::Term& column : columns) {
    expected.push_back(column.label);
    expected_text += (expected_text.empty() ? "" : ", ") + column.label;
  }
  if (headings != expected) throw section.error("columns", "must be the terms of EC in their order: " + expected_text);

  controller.rules.rows = rows.size();
  controller.rules.columns = columns.size();
  for (const fuzzy::Term& row : rows) {
    const std::vector<std::string> cells = section.texts(row.label);
    if (cells.size() != columns.size())
      throw section.error(row.label, "has " + std::to_string(cells.size()) + " cells; one for each of the " +
                                         std::to_string(columns.size()) + " columns is needed: " + expected_text);
    for (std::size_t j = 0; j < cells.size(); ++j) {
      try {
        controller.rules.consequents.push_back(controller.output.index_of(cells[j]));
      } catch (const std::invalid_argument& problem) {
        throw section.error(row.label + "." + columns[j].label, problem.what());
      }
    }
  }
  section.finish();
}

Controller read_yaml(YamlSection& file) {
  Controller controller;
  controller.name = file.text("name");
  controller.error = read_variable(file, "E");
  controller.error_change = read_variable(file, "EC");
  controller.output = read_variable(file, "U");
  read_rules(file, controller);
  file.finish();
  return controller;
}

}  // namespace

Controller load_fuzzy_controller(const std::filesystem::path& path) {
  return parse_fuzzy_controller(read_text_file(path));
}

Controller parse_fuzzy_controller(const TextFile& file) {
  Controller controller;
  if (file.path.extension() == ".fll") {
    controller = read_fll(file.text, file.path, file.key);
  } else {
    YamlSection root = YamlSection::parse(file);
    controller = read_yaml(root);
  }
  try {
    fuzzy::validate(controller);
  } catch (const fuzzy::ValidationError& defect) {
    throw ConfigError(defect.where(), defect.problem() + " (in " + file.path.string() + ")");
  }
  return controller;
}

}  // namespace pilotfish::config
