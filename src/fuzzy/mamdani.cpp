#include "pilotfish/fuzzy/mamdani.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotfish/fuzzy/centroid.hpp"

namespace pilotfish::fuzzy {

Inference infer(const Controller& controller, double error, double error_change) noexcept {
  Inference inference;
  if (std::isnan(error) || std::isnan(error_change)) {
    inference.output = std::numeric_limits<double>::quiet_NaN();
    return inference;
  }

  // Fuzzification: singletons, saturated at the ends of the universes.
  std::array<double, kPaperRows> error_degrees;
  std::array<double, kPaperColumns> change_degrees;
  const double e = controller.error.saturate(error), ec = controller.error_change.saturate(error_change);
  for (std::size_t i = 0; i < kPaperRows; ++i) error_degrees[i] = membership(controller.error.terms[i].set, e);
  for (std::size_t j = 0; j < kPaperColumns; ++j)
    change_degrees[j] = membership(controller.error_change.terms[j].set, ec);

  // Rules: (4) gives each its strength; (5) clips its consequent there. Clipping the same term twice and
  // joining by max, (6), is clipping it once at the greater strength.
  std::array<double, kMaxTerms> heights{};
  for (std::size_t i = 0; i < kPaperRows; ++i) {
    for (std::size_t j = 0; j < kPaperColumns; ++j) {
      const std::size_t rule = i * kPaperColumns + j;
      inference.strengths[rule] = std::min(error_degrees[i], change_degrees[j]);
      double& height = heights[controller.rules.consequents[rule]];
      height = std::max(height, inference.strengths[rule]);
    }
  }

  // Defuzzification (7). saturate() takes back a rounding error at the ends of the universe.
  const Moments moments = clipped_union_moments(controller.output, heights.data());
  inference.output = controller.output.saturate(moments.first / moments.area);
  return inference;
}

}  // namespace pilotfish::fuzzy
