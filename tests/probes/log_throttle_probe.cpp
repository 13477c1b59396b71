// log_throttle_probe PERIOD_S: reads "kind time_us" lines, and answers each with the number kept back if a line is due,
// else "-".
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

#include "log_throttle.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  pilotfish::apps::LogThrottle throttle(std::atof(argv[1]));
  std::string kind;
  for (std::int64_t time_us = 0; std::cin >> kind >> time_us;) {
    const auto kept_back = throttle.due(kind, {time_us});
    std::cout << (kept_back ? std::to_string(*kept_back) : "-") << "\n";
  }
  return 0;
}
