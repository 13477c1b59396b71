// search_budget_probe FRAME_RATE_HZ MAX_AGE_S: reads how long each search of a picture took [ms]; says of each whether
// it was to be coarse, and "warned" behind the first that took too long.
#include <cstdlib>
#include <iostream>

#include "coordinator/search_budget.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 64;
  pilotfish::apps::SearchBudget budget(std::atof(argv[1]), std::atof(argv[2]));
  for (double took_ms = 0.0; std::cin >> took_ms;) {
    const bool coarse = budget.coarse(), warned = budget.searched(took_ms * 1e-3);
    std::cout << (coarse ? "coarse" : "whole") << (warned ? " warned" : "") << "\n";
  }
  return 0;
}
