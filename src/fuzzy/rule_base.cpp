#include "pilotfish/fuzzy/rule_base.hpp"

namespace pilotfish::fuzzy {

std::string describe_rule(const Controller& controller, std::size_t rule) {
  const std::size_t columns = controller.rules.columns;
  const auto is = [](const LinguisticVariable& variable, std::size_t term) {
    return variable.name + " is " + variable.terms.at(term).label;
  };
  const std::size_t consequent = controller.rules.consequents.at(rule);
  return "IF " + is(controller.error, rule / columns) + " AND " + is(controller.error_change, rule % columns) +
         " THEN " + is(controller.output, consequent);
}

}  // namespace pilotfish::fuzzy
