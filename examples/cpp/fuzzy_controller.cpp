// A Mamdani controller of one's own, after the paper's pattern (8 x 7 rules), that keeps a cart 1 m behind a leader.
// Needs nothing but the standard library.

#include <cstdio>
#include <limits>
#include <pilotfish/fuzzy/mamdani.hpp>
#include <string>
#include <vector>

namespace fuzzy = pilotfish::fuzzy;

/// Triangles whose feet stand under the neighbours' peaks, and open shoulders at both ends.
fuzzy::LinguisticVariable variable(const std::string& name, const std::vector<std::string>& labels,
                                   const std::vector<double>& peaks, bool open) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  fuzzy::LinguisticVariable result{name, -1.0, 1.0, {}};
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double peak = peaks[i];
    const double left = i > 0 ? peaks[i - 1] : peak - 0.3, right = i + 1 < peaks.size() ? peaks[i + 1] : peak + 0.3;
    if (open && i == 0)
      result.terms.push_back({labels[i], fuzzy::Trapezoid{-kFar, -kFar, peak, right}});
    else if (open && i + 1 == labels.size())
      result.terms.push_back({labels[i], fuzzy::Trapezoid{left, peak, kFar, kFar}});
    else
      result.terms.push_back({labels[i], fuzzy::Triangle{left, peak, right}});
  }
  return result;
}

int main() {
  fuzzy::Controller controller;
  controller.name = "cart";
  controller.error = variable("E", {"NB", "NM", "NS", "NZ", "PZ", "PS", "PM", "PB"},
                              {-0.9, -0.6, -0.3, -0.02, 0.02, 0.3, 0.6, 0.9}, true);
  const std::vector<std::string> seven = {"NB", "NM", "NS", "ZE", "PS", "PM", "PB"};
  const std::vector<double> peaks = {-0.9, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9};
  controller.error_change = variable("EC", seven, peaks, true);
  controller.output = variable("U", seven, peaks, false);
  // Too far (E negative) or getting farther (EC negative): faster. One step of U for one step of either.
  controller.rules.rows = 8;
  controller.rules.columns = 7;
  for (int row = 0; row < 8; ++row)
    for (int column = 0; column < 7; ++column) {
      const int step = (row < 4 ? 3 - row : 4 - row) + (3 - column);
      controller.rules.consequents.push_back(static_cast<std::size_t>(3 + (step > 3 ? 3 : step < -3 ? -3 : step)));
    }
  fuzzy::validate(controller);  // throws, naming the set or the rule, if some input had no answer

  double gap_m = 1.8, last_error_m = 1.0 - gap_m;
  for (int step = 0; step <= 60; ++step) {
    const double error_m = 1.0 - gap_m;
    const double speed = fuzzy::infer_output(controller, error_m, error_m - last_error_m);
    if (step % 10 == 0) std::printf("%4.1f s: %.3f m behind, %+.2f m/s relative\n", step * 0.1, gap_m, speed);
    gap_m -= 0.1 * speed;
    last_error_m = error_m;
  }
}
