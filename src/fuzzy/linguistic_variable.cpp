#include "pilotfish/fuzzy/linguistic_variable.hpp"

#include <cmath>
#include <set>
#include <sstream>

namespace pilotfish::fuzzy {

std::size_t LinguisticVariable::index_of(const std::string& label) const {
  std::string labels;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].label == label) return i;
    labels += (i == 0 ? "" : ", ") + terms[i].label;
  }
  throw std::invalid_argument("'" + label + "' is not a term of " + name + "; terms: " + labels);
}

void validate(const LinguisticVariable& variable) {
  if (!std::isfinite(variable.min) || !std::isfinite(variable.max) || !(variable.min < variable.max)) {
    std::ostringstream problem;
    problem << "[" << variable.min << ", " << variable.max << "] is not a finite interval";
    throw ValidationError(variable.name + ".universe", problem.str());
  }
  const std::string terms = variable.name + ".terms";
  if (variable.terms.empty() || variable.terms.size() > kMaxTerms)
    throw ValidationError(terms, "has " + std::to_string(variable.terms.size()) + " terms; 1 to " +
                                     std::to_string(kMaxTerms) + " are possible");
  std::set<std::string> labels;
  for (const Term& term : variable.terms) {
    if (term.label.empty()) throw ValidationError(terms, "has a term without a label");
    if (!labels.insert(term.label).second) throw ValidationError(terms + "." + term.label, "is there twice");
    try {
      validate(term.set);
    } catch (const std::invalid_argument& problem) {
      throw ValidationError(terms + "." + term.label, problem.what());
    }
  }
}

}  // namespace pilotfish::fuzzy
