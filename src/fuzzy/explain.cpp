#include "pilotfish/fuzzy/explain.hpp"

#include <algorithm>
#include <cstdio>

#include "envelope.hpp"

namespace pilotfish::fuzzy {

Explanation explain(const Controller& controller, double error, double error_change, const InputWidths& widths) {
  Explanation explanation;
  explanation.inference = infer(controller, error, error_change, widths);
  explanation.term_strengths.assign(controller.output.terms.size(), 0.0);
  for (std::size_t rule = 0; rule < kPaperRules; ++rule) {
    const double strength = explanation.inference.strengths[rule];
    if (!(strength > 0.0)) continue;
    std::array<char, 16> shown{};
    std::snprintf(shown.data(), shown.size(), ", %.2f", strength);
    explanation.firing.push_back({rule, strength, describe_rule(controller, rule) + shown.data()});
    double& height = explanation.term_strengths[controller.rules.consequents[rule]];
    height = std::max(height, strength);
  }
  std::stable_sort(explanation.firing.begin(), explanation.firing.end(),
                   [](const FiringRule& a, const FiringRule& b) { return a.strength > b.strength; });
  if (!explanation.firing.empty())
    explanation.clipped = clipped_union_polyline(controller.output, explanation.term_strengths.data());
  return explanation;
}

std::vector<std::array<double, 2>> clipped_union_polyline(const LinguisticVariable& output,
                                                          const double* term_strengths, int gaussian_points) {
  std::vector<std::array<double, 2>> points;
  const auto add = [&points](double u, double degree) {
    const std::array<double, 2> point = {u, std::max(degree, 0.0)};
    if (points.empty() || points.back() != point) points.push_back(point);
  };
  Envelope(output, term_strengths).for_each([&](double begin, double end, const Arc& arc) {
    const int steps = arc.is_gaussian() ? std::max(gaussian_points, 1) : 1;
    for (int i = 0; i <= steps; ++i) {
      const double u = i == steps ? end : begin + (end - begin) * i / steps;
      add(u, arc(u));
    }
  });
  return points;
}

}  // namespace pilotfish::fuzzy
