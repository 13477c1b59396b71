#include <cmath>
#include <sstream>

#include "envelope.hpp"
#include "pilotfish/fuzzy/centroid.hpp"
#include "pilotfish/fuzzy/mamdani.hpp"
#include "pilotfish/fuzzy/rule_base.hpp"
#include "plan.hpp"

namespace pilotfish::fuzzy {
namespace {

template <class... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream out;
  (out << ... << parts);
  return out.str();
}

void check_areas(const LinguisticVariable& variable) {
  constexpr double kMinShare = 1e-9;  // of the universe's width; below, the quotient of moments would lose its digits
  for (std::size_t k = 0; k < variable.terms.size(); ++k) {
    std::array<double, kMaxTerms> term_strengths{};
    term_strengths[k] = 1.0;
    const double area = clipped_union_moments(variable, term_strengths.data()).area;
    if (!(area > kMinShare * (variable.max - variable.min)))
      throw ValidationError(variable.name + ".terms." + variable.terms[k].label,
                            text("has no area inside the universe [", variable.min, ", ", variable.max, "]"));
  }
}

// The envelope of all terms is monotone along each of its arcs, so the weakest degree is at an arc's end (as
// a limit from inside the arc, which also finds a gap behind a vertical side).
void check_coverage(const LinguisticVariable& variable) {
  const std::string where = variable.name + ".terms";
  std::array<double, kMaxTerms> term_strengths;
  term_strengths.fill(1.0);
  double weakest = 1.0, weakest_at = variable.min;
  Envelope(variable, term_strengths.data()).for_each([&](double begin, double end, const Arc& arc) {
    if (arc(begin) <= 0.0 && arc(end) <= 0.0) throw ValidationError(where, text("no term covers ", begin, " to ", end));
    for (double x : {begin, end}) {
      if (arc(x) >= weakest) continue;
      weakest = arc(x);
      weakest_at = x;
    }
  });
  if (!(weakest > kMinCoverage))
    throw ValidationError(where, text("no term covers ", weakest_at, " well: the greatest degree there is ",
                                      std::max(weakest, 0.0), ", more than ", kMinCoverage, " is needed"));
}

void check_rules(const Controller& c) {
  const auto count = [](const LinguisticVariable& variable, std::size_t expected) {
    if (variable.terms.size() != expected)
      throw ValidationError(variable.name + ".terms",
                            text("has ", variable.terms.size(), " terms; the rule base needs ", expected));
  };
  count(c.error, kPaperRows);
  count(c.error_change, kPaperColumns);
  if (c.rules.rows != kPaperRows || c.rules.columns != kPaperColumns || c.rules.size() != kPaperRules)
    throw ValidationError(
        "rules", text("has ", c.rules.size(), " cells in ", c.rules.rows, " rows of ", c.rules.columns, "; needed are ",
                      kPaperRules, " in ", kPaperRows, " rows of ", kPaperColumns));
  for (std::size_t rule = 0; rule < kPaperRules; ++rule) {
    if (c.rules.consequents[rule] < c.output.terms.size()) continue;
    const std::string where =
        "rules." + c.error.terms[rule / kPaperColumns].label + "." + c.error_change.terms[rule % kPaperColumns].label;
    throw ValidationError(where, text(c.rules.consequents[rule], " is not the index of a term of ", c.output.name,
                                      ", which has ", c.output.terms.size()));
  }
}

std::vector<double> corner_points(const LinguisticVariable& variable) {
  std::vector<double> points{variable.min, variable.max};
  for (const Term& term : variable.terms)
    for (double level : {0.0, 0.5, 1.0})
      for (double x : level_cut(term.set, level)) points.push_back(variable.saturate(x));
  return points;
}

void check_output(const Controller& c) {
  for (double e : corner_points(c.error)) {
    for (double ec : corner_points(c.error_change)) {
      const double u = infer(c, e, ec).output;
      if (std::isfinite(u) && u >= c.output.min && u <= c.output.max) continue;
      throw ValidationError(c.output.name,
                            text("is ", u, " at ", c.error.name, " = ", e, ", ", c.error_change.name, " = ", ec));
    }
  }
}

}  // namespace

void validate(Controller& controller) {
  controller.plan = nullptr;  // of what was validated before: should this fail, nothing is validated
  for (const LinguisticVariable* variable : {&controller.error, &controller.error_change, &controller.output}) {
    validate(*variable);
    check_areas(*variable);
  }
  check_coverage(controller.error);
  check_coverage(controller.error_change);
  check_rules(controller);
  Controller planned = controller;
  planned.plan = std::make_shared<const Plan>(planned);
  check_output(planned);
  controller.plan = std::move(planned.plan);
}

}  // namespace pilotfish::fuzzy
