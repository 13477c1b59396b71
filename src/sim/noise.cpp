#include "noise.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"
#include "random.hpp"

namespace pilotfish::sim {
namespace {

/// z with Phi(z) = p for p >= 1/2, by Newton from z = 0: Phi is concave there, so the steps come from below and stop.
double normal_quantile(double p) {
  double z = 0.0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double density = std::exp(-z * z / 2.0) / std::sqrt(2.0 * kPi);
    z += (p - 0.5 * std::erfc(-z / std::sqrt(2.0))) / density;
  }
  return z;
}

}  // namespace

NoiseTable::NoiseTable(double sigma) {
  constexpr int size = 1 << kBits;
  std::array<double, size> quantiles;
  double variance = 0.0;
  for (int i = size / 2; i < size; ++i) {
    const double z = normal_quantile((i + 0.5) / size);
    quantiles[static_cast<std::size_t>(i)] = z;
    quantiles[static_cast<std::size_t>(size - 1 - i)] = -z;
    variance += 2.0 * z * z / size;
  }
  for (std::size_t i = 0; i < size; ++i)
    table_[i] = static_cast<std::int32_t>(std::lround(256.0 * sigma * quantiles[i] / std::sqrt(variance)));
}

void NoiseTable::expose(const std::vector<std::uint16_t>& grays, double gain, std::uint64_t seed,
                        std::vector<std::uint8_t>& pixels) const {
  pixels.resize(grays.size());
  const auto gain_256 = static_cast<std::int64_t>(std::lround(gain * 256.0));
  constexpr int per_number = 64 / kBits;
  constexpr std::uint64_t mask = (1U << kBits) - 1U;
  Random random(seed);
  for (std::size_t i = 0; i < grays.size();) {
    std::uint64_t bits = random.next();
    const std::size_t end = std::min(grays.size(), i + per_number);
    for (; i < end; ++i, bits >>= kBits) {
      const std::int64_t gray = ((grays[i] * gain_256) >> 8) + table_[bits & mask];
      pixels[i] = static_cast<std::uint8_t>(std::clamp<std::int64_t>((gray + 128) >> 8, 0, 255));
    }
  }
}

}  // namespace pilotfish::sim
