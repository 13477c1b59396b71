#pragma once

#include <variant>

#include "pilotfish/fuzzy/membership.hpp"

namespace pilotfish::fuzzy {

/// function(shape), for the shape that the set is. Unlike std::visit this cannot throw: copying doubles never
/// leaves a variant without a value, but a compiler cannot know that.
template <class Function>
auto with_shape(const MembershipFunction& set, Function function) {
  if (const auto* triangle = std::get_if<Triangle>(&set)) return function(*triangle);
  if (const auto* trapezoid = std::get_if<Trapezoid>(&set)) return function(*trapezoid);
  return function(*std::get_if<Gaussian>(&set));
}

}  // namespace pilotfish::fuzzy
