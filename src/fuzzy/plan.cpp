#include "plan.hpp"

#include <map>

namespace pilotfish::fuzzy {

Plan::Plan(const Controller& controller) : error(controller.error), error_change(controller.error_change) {
  for (std::size_t rule = 0; rule < kPaperRules; ++rule)
    consequents[rule] = static_cast<std::uint32_t>(controller.rules.consequents[rule]);
  if (!OrderedUnion::fits(controller.output)) return;
  output.emplace(controller.output);
  const std::size_t terms = controller.output.terms.size();
  sums.push_back(output->sum_over(std::vector<bool>(terms, true)));

  // At most 8 x 7 different sets of rules fire together for each pair of corners, and far fewer sets of consequents.
  std::map<std::vector<bool>, std::size_t> known;
  for (std::size_t i = 0; i < error.stretches(); ++i) {
    for (std::size_t j = 0; j < error_change.stretches(); ++j) {
      std::vector<bool> active(terms, false);
      for (std::size_t row : error.terms_on(i))
        for (std::size_t column : error_change.terms_on(j)) active[consequents[row * kPaperColumns + column]] = true;
      const auto [entry, is_new] = known.emplace(active, sums.size());
      if (is_new) sums.push_back(output->sum_over(active));
      sum_at.push_back(static_cast<std::uint32_t>(entry->second));
    }
  }
}

}  // namespace pilotfish::fuzzy
