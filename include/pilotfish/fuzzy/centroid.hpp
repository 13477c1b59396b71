#pragma once

#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/fuzzy/linguistic_variable.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::fuzzy {

/// Area and first moment of a membership function over an interval: int mu du and int u mu du.
struct Moments {
  double area = 0.0;   ///< integral of mu(u) du over the universe
  double first = 0.0;  ///< integral of u mu(u) du; the centroid is first / area
};

/// Moments of mu_C'(u) = max_k min(term_strengths[k], mu_k(u)) over the universe of `output`: each term clipped at
/// the strength of its rules and joined by max. For triangles and trapezoids mu_C' is piecewise linear and
/// this is the closed form; with Gaussians, the pieces between breakpoints are integrated with erf (exact as
/// well, up to rounding). term_strengths: one per term, in [0, 1].
Moments clipped_union_moments(const LinguisticVariable& output, const double* term_strengths) noexcept;

/// The same moments the way inference computes them: if the terms are triangles and trapezoids in order on the axis (no
/// corner of a term is left of the same corner of the term before), they are sums of polynomials in the term_strengths,
/// and no breakpoint is computed; see src/fuzzy/layers.hpp. Nothing otherwise. Prepares the polynomials at every call:
/// for tests and inspection.
std::optional<Moments> ordered_union_moments(const LinguisticVariable& output, const double* term_strengths);

}  // namespace pilotfish::fuzzy
PILOTFISH_API_END
