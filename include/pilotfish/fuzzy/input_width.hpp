#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/fuzzy/linguistic_variable.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::fuzzy {

/// The shape of a fuzzified input A' around the measured value x, of width w:
/// triangle  mu_A'(t) = max(0, 1 - |t - x|/w),   gaussian  mu_A'(t) = exp(-(t - x)^2/(2 w^2)).
enum class WidthShape { triangle, gaussian };

/// How wide the inputs A' and B' of eq. (6) are, in units of their universes. Zero is a singleton: the value as
/// measured.
struct InputWidths {
  double error = 0.0;                       ///< width of A', in units of E's universe; 0: a singleton
  double error_change = 0.0;                ///< width of B', in units of EC's universe; 0: a singleton
  WidthShape shape = WidthShape::triangle;  ///< WidthShape of both
};

/// The degree of possibility of A', of a width >= 0 around x, in a term: sup_t min(mu_A'(t), mu_A(t)) over the universe
/// of `variable`. That is eq. (6) for one input: the sup of minima over e and ec separates into one for each. It tends
/// to membership(term, x) as the width goes to 0, and is that for 0. x inside the universe.
double possibility(const LinguisticVariable& variable, const MembershipFunction& term, double x, double width,
                   WidthShape shape) noexcept;

}  // namespace pilotfish::fuzzy
PILOTFISH_API_END
