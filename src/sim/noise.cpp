#include "noise.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"
#include "random.hpp"

namespace pilotfish::sim {
namespace {

constexpr int kWhite = 4080;  ///< gray 255 in 1/16

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

NoiseTable::NoiseTable(double sigma, double shot, double gamma) : even_(shot == 0.0 && gamma == 1.0) {
  constexpr int size = 1 << kBits;
  const double largest = std::hypot(sigma, shot);
  std::array<double, size> quantiles;
  double variance = 0.0;
  for (int i = size / 2; i < size; ++i) {
    const double z = normal_quantile((i + 0.5) / size);
    quantiles[static_cast<std::size_t>(i)] = z;
    quantiles[static_cast<std::size_t>(size - 1 - i)] = -z;
    variance += 2.0 * z * z / size;
  }
  for (std::size_t i = 0; i < size; ++i)
    table_[i] = static_cast<std::int32_t>(std::lround(256.0 * largest * quantiles[i] / std::sqrt(variance)));
  for (std::size_t gray = 0; gray < scale_.size(); ++gray) {
    const double here = std::sqrt(sigma * sigma + shot * shot * static_cast<double>(gray) / 255.0);
    scale_[gray] = largest > 0.0 ? static_cast<std::int32_t>(std::lround(256.0 * here / largest)) : 0;
  }
  response_.resize(kWhite + 1);
  for (std::size_t i = 0; i < response_.size(); ++i)
    response_[i] =
        static_cast<std::uint8_t>(std::lround(255.0 * std::pow(static_cast<double>(i) / kWhite, 1.0 / gamma)));
}

void NoiseTable::expose(const std::vector<std::uint16_t>& grays, double gain, std::uint64_t seed,
                        std::vector<std::uint8_t>& pixels) const {
  pixels.resize(grays.size());
  const auto gain_256 = static_cast<std::int64_t>(std::lround(gain * 256.0));
  if (even_) return expose_evenly(grays, gain_256, seed, pixels);
  Random random(seed);
  for (std::size_t i = 0; i < grays.size(); ++i) {
    const std::int64_t light = (grays[i] * gain_256) >> 8;  // in 1/256
    const std::int64_t at = std::clamp<std::int64_t>(light >> 8, 0, 255);
    const std::int64_t noise =
        (static_cast<std::int64_t>(table_[random.next() & ((1U << kBits) - 1U)]) * scale_[at]) >> 8;
    pixels[i] = response_[static_cast<std::size_t>(std::clamp<std::int64_t>((light + noise + 8) >> 4, 0, kWhite))];
  }
}

void NoiseTable::expose_evenly(const std::vector<std::uint16_t>& grays, std::int64_t gain_256, std::uint64_t seed,
                               std::vector<std::uint8_t>& pixels) const {
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
