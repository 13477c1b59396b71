#pragma once

#include "pilotfish/fuzzy/rule_base.hpp"

namespace pilotfish::tests {

/// Triangles side by side on [-1, 1], each from the peak before to the peak behind: at every point two of them add up
/// to 1.
inline fuzzy::LinguisticVariable even_terms(const std::string& name, int count) {
  fuzzy::LinguisticVariable variable;
  variable.name = name;
  const double apart = 2.0 / (count - 1);
  for (int i = 0; i < count; ++i) {
    const double peak = -1.0 + apart * i;
    variable.terms.push_back({name + std::to_string(i), fuzzy::Triangle{peak - apart, peak, peak + apart}});
  }
  return variable;
}

/// A controller that drives faster the farther the leader is, whatever the change: U's term of the 8 rows of E is 6, 5,
/// 4, 3, 3, 2, 1, 0, which is odd about the middle. Not validated yet.
inline fuzzy::Controller even_controller() {
  fuzzy::Controller controller;
  controller.name = "even";
  controller.error = even_terms("E", fuzzy::kPaperRows);
  controller.error_change = even_terms("EC", fuzzy::kPaperColumns);
  controller.output = even_terms("U", 7);
  controller.rules.rows = fuzzy::kPaperRows;
  controller.rules.columns = fuzzy::kPaperColumns;
  for (std::size_t consequent : {6, 5, 4, 3, 3, 2, 1, 0})
    for (std::size_t column = 0; column < fuzzy::kPaperColumns; ++column)
      controller.rules.consequents.push_back(consequent);
  return controller;
}

inline fuzzy::Controller validated_controller() {
  fuzzy::Controller controller = even_controller();
  fuzzy::validate(controller);
  return controller;
}

}  // namespace pilotfish::tests
