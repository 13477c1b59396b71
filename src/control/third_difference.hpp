#pragma once

#include <array>
#include <cstddef>

#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {

/// Weights w_i = 1 / prod_{j != i} (t_i - t_j) of the third divided difference of four values, and the sum of their
/// squares: see MeasurementNoise.
struct ThirdDifference {
  std::array<double, 4> weight{};
  double norm2 = 0.0;
};

/// `four`: anything with four elements that have a `utime`, all different.
template <class Four>
ThirdDifference third_difference(const Four& four) {
  ThirdDifference result;
  for (std::size_t i = 0; i < 4; ++i) {
    double product = 1.0;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) product *= seconds_between(four[j].utime, four[i].utime);
    result.weight[i] = 1.0 / product;
    result.norm2 += result.weight[i] * result.weight[i];
  }
  return result;
}

}  // namespace pilotfish::control
