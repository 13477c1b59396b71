#pragma once

#include <array>

#include "pilotfish/api.hpp"
#include "pilotfish/fuzzy/input_width.hpp"
#include "pilotfish/fuzzy/rule_base.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::fuzzy {

/// The result of one inference, with the firing strength of each of the 56 rules, eq. (4).
struct Inference {
  double output;                              ///< u*, eq. (7), inside the universe of U
  std::array<double, kPaperRules> strengths;  ///< [row * kPaperColumns + column]

  Inference() noexcept : output(0.0), strengths{} {}
  /// Every strength is `nothing`; see infer().
  explicit Inference(double nothing) noexcept : output(nothing) { strengths.fill(nothing); }
};

/// Mamdani inference: min for AND (4), min for the implication (5), max over the rules, (6), and the exact centroid
/// (7). Inputs outside the universes saturate. With widths, the inputs are the fuzzy sets A' and B' of (6); without,
/// they are singletons. Never allocates. The controller must have passed validate(). NaN in, an infinite width or a
/// missing validate() gives NaN out: callers check.
Inference infer(const Controller& controller, double error, double error_change,
                const InputWidths& widths = {}) noexcept;

/// u* alone, the same bits, for batches that do not need the strengths.
double infer_output(const Controller& controller, double error, double error_change,
                    const InputWidths& widths = {}) noexcept;

}  // namespace pilotfish::fuzzy
PILOTFISH_API_END
