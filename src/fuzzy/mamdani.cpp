#include "pilotfish/fuzzy/mamdani.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plan.hpp"

namespace pilotfish::fuzzy {
namespace {

constexpr std::size_t kEverywhere = static_cast<std::size_t>(-1);

// A non-singleton input may overlap every term.
void fuzzify_non_singleton(const LinguisticVariable& variable, double x, double width, WidthShape shape,
                           FuzzifiedInput& fuzzified) noexcept {
  for (std::uint32_t k = 0; k < variable.terms.size(); ++k) {
    fuzzified.term[k] = k;
    fuzzified.degree[k] = possibility(variable, variable.terms[k].set, x, width, shape);
  }
  fuzzified.count = variable.terms.size();
}

// Fuzzification. Returns the stretch of a singleton, on which few terms fire.
std::size_t fuzzify(const LinguisticVariable& variable, const Fuzzifier& prepared, double x, double width,
                    WidthShape shape, FuzzifiedInput& fuzzified) noexcept {
  const double saturated = variable.saturate(x);
  if (width > 0.0) {
    fuzzify_non_singleton(variable, saturated, width, shape, fuzzified);
    return kEverywhere;
  }
  const std::size_t stretch = prepared.stretch_of(saturated);
  prepared.fuzzify(saturated, stretch, fuzzified);
  return stretch;
}

// The moments of (7). [0] is the sum over all terms, whatever fires.
Moments clipped_moments(const Controller& controller, std::size_t row_stretch, std::size_t column_stretch,
                        const double* term_strengths) noexcept {
  const Plan& plan = *controller.plan;
  if (!plan.output) return clipped_union_moments(controller.output, term_strengths);
  const bool anywhere = row_stretch == kEverywhere || column_stretch == kEverywhere;
  const std::size_t sum = anywhere ? 0 : plan.sum_at[row_stretch * plan.error_change.stretches() + column_stretch];
  return plan.output->moments(plan.sums[sum], term_strengths);
}

// on_rule(rule, strength) is called for every rule that may fire; the others have the strength 0.
template <class OnRule>
double infer_telling(const Controller& controller, double error, double error_change, const InputWidths& widths,
                     OnRule on_rule) noexcept {
  if (std::isnan(error) || std::isnan(error_change) || !std::isfinite(widths.error) ||
      !std::isfinite(widths.error_change) || controller.plan == nullptr)
    return std::numeric_limits<double>::quiet_NaN();
  const Plan& plan = *controller.plan;
  FuzzifiedInput rows, columns;
  const std::size_t row_stretch = fuzzify(controller.error, plan.error, error, widths.error, widths.shape, rows);
  const std::size_t column_stretch =
      fuzzify(controller.error_change, plan.error_change, error_change, widths.error_change, widths.shape, columns);

  // Rules: (4) gives each its strength; (5) clips its consequent there. Clipping the same term twice and
  // joining by max, (6), is clipping it once at the greater strength.
  // Nothing is -0.0 here, see infer(); no sum below can tell the zeros apart.
  std::array<double, kMaxTerms> term_strengths;
  term_strengths.fill(-0.0);
  for (std::size_t i = 0; i < rows.count; ++i) {
    for (std::size_t j = 0; j < columns.count; ++j) {
      const std::size_t rule = rows.term[i] * kPaperColumns + columns.term[j];
      const double strength = std::min(rows.degree[i], columns.degree[j]);
      on_rule(rule, strength);
      const std::size_t consequent = plan.consequents[rule];
      term_strengths[consequent] = std::max(term_strengths[consequent], strength);
    }
  }

  // Defuzzification (7). saturate() takes back a rounding error at the ends of the universe.
  const Moments moments = clipped_moments(controller, row_stretch, column_stretch, term_strengths.data());
  return controller.output.saturate(moments.first / moments.area);
}

}  // namespace

Inference infer(const Controller& controller, double error, double error_change, const InputWidths& widths) noexcept {
  // A zero that the compiler cannot recognise as one: GCC fills an array with zero bytes by a string instruction that
  // takes as long as a third of all the rest.
  Inference inference(0.0 * std::abs(controller.error.max));
  inference.output =
      infer_telling(controller, error, error_change, widths,
                    [&inference](std::size_t rule, double strength) noexcept { inference.strengths[rule] = strength; });
  return inference;
}

double infer_output(const Controller& controller, double error, double error_change,
                    const InputWidths& widths) noexcept {
  return infer_telling(controller, error, error_change, widths, [](std::size_t, double) noexcept {});
}

}  // namespace pilotfish::fuzzy
