#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "fuzzifier.hpp"
#include "layers.hpp"
#include "pilotfish/fuzzy/rule_base.hpp"

namespace pilotfish::fuzzy {

/// What validate() prepares of a controller, so that inference only looks up and adds.
struct Plan {
  /// controller: validated up to here, all but its output.
  explicit Plan(const Controller& controller);

  Fuzzifier error, error_change;
  std::array<std::uint32_t, kPaperRules> consequents;
  /// Not there if the output's terms are Gaussians or out of order: then the envelope is searched for its knees.
  std::optional<OrderedUnion> output;
  /// The sums that occur: [0] over all terms of U, then one for each set of terms that fire together somewhere.
  std::vector<OrderedUnion::Sum> sums;
  /// Which sum: [stretch of e * error_change.stretches() + stretch of ec].
  std::vector<std::uint32_t> sum_at;
};

}  // namespace pilotfish::fuzzy
