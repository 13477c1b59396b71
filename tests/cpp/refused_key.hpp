#pragma once

#include <string>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish::tests {

/// The key of the ConfigError that `work` throws; "nothing" if it throws none.
template <class Work>
std::string refused_key(Work&& work) {
  try {
    work();
  } catch (const ConfigError& error) {
    return error.key();
  }
  return "nothing";
}

}  // namespace pilotfish::tests
