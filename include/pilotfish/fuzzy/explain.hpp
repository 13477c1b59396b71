#pragma once

#include <array>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/fuzzy/mamdani.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::fuzzy {

/// A rule that fires and how strongly: "IF E is NS AND EC is ZE THEN U is PM, 0.62".
struct FiringRule {
  std::size_t rule = 0;   ///< row * kPaperColumns + column
  double strength = 0.0;  ///< its strength, eq. (4), in (0, 1]
  std::string text;       ///< the rule and its strength in words
};

/// One inference with its intermediate results, for inspection; infer() is for the control loop.
struct Explanation {
  Inference inference;                         ///< output and all 56 strengths
  std::vector<FiringRule> firing;              ///< strength above zero, strongest first
  std::vector<double> term_strengths;          ///< where each term of U is clipped, (5) and (6)
  std::vector<std::array<double, 2>> clipped;  ///< {u, mu_C'(u)}: the corners of the set whose centroid is the output
};

/// Of NaN inputs, no rule fires and nothing is clipped. The controller must have passed validate().
Explanation explain(const Controller& controller, double error, double error_change, const InputWidths& widths = {});

/// max_k min(term_strengths[k], mu_k(u)) over the universe of `output` as a polyline {u, mu}, which jumps at vertical
/// sides. Exact for triangles and trapezoids; a Gaussian's flank has `gaussian_points` points. term_strengths: one for
/// each term.
std::vector<std::array<double, 2>> clipped_union_polyline(const LinguisticVariable& output,
                                                          const double* term_strengths, int gaussian_points = 24);

}  // namespace pilotfish::fuzzy
PILOTFISH_API_END
