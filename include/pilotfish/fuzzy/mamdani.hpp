#pragma once

#include <array>

#include "pilotfish/fuzzy/rule_base.hpp"

namespace pilotfish::fuzzy {

/// What one inference says, with the reason: the strength min(mu_A(e), mu_B(ec)) of each of the 56 rules, eq. (4).
struct Inference {
  double output = 0.0;                          ///< u*, eq. (7), inside the universe of U
  std::array<double, kPaperRules> strengths{};  ///< [row * kPaperColumns + column]
};

/// Mamdani inference with singleton inputs: min for AND (4), min for the implication (5), max over the rules,
/// (6), and the exact centroid (7). Inputs outside the universes saturate. The controller must have passed
/// prove(). NaN in gives NaN out: callers check.
Inference infer(const Controller& controller, double error, double error_change) noexcept;

}  // namespace pilotfish::fuzzy
