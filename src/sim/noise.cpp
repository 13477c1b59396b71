#include "noise.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/angles.hpp"
#include "random.hpp"
#include "wider_registers.hpp"

namespace pilotfish::sim {
namespace {

constexpr int kWhite = 4080;  ///< gray 255 in 1/16

/// z with Phi(z) = p for p >= 1/2, by Newton from z = 0: Phi is concave there, so the steps come from below and stop.
double normal_quantile(double p) {
  double z = 0.0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double before = z, density = std::exp(-z * z / 2.0) / std::sqrt(2.0 * kPi);
    z += (p - 0.5 * std::erfc(-z / std::sqrt(2.0))) / density;
    if (z == before) break;  // so would all that follow
  }
  return z;
}

/// The numbers first + 1, first + 2, ... of a seed.
PILOTFISH_FOR_WIDER_REGISTERS
void draw_numbers(std::uint64_t seed, std::uint64_t first, std::size_t count, std::uint64_t* numbers) {
  for (std::size_t i = 0; i < count; ++i) numbers[i] = Random::mixed(seed + (first + i + 1) * Random::kStep);
}

/// The brighter, the more noise; then the response. `scale` in 1/256, `light` in 1/256 gray levels, `response` by 1/16.
PILOTFISH_FOR_WIDER_REGISTERS
void add_shot_noise(const std::uint16_t* grays, const std::int32_t* table, const std::uint64_t* numbers,
                    std::uint64_t mask, const std::int32_t* scale, const std::int32_t* response, std::int32_t gain_256,
                    std::size_t count, std::uint8_t* pixels) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t light = (grays[i] * gain_256) >> 8;
    const std::int32_t at = std::min(light >> 8, 255);
    const std::int32_t noise = (table[numbers[i] & mask] * scale[at]) >> 8;
    pixels[i] = static_cast<std::uint8_t>(response[std::min(std::max((light + noise + 8) >> 4, 0), kWhite)]);
  }
}

/// pixels[i] = clip((grays[i] * gain_256 / 256 + noise[i]) / 256), rounded.
PILOTFISH_FOR_WIDER_REGISTERS
void add_noise(const std::uint16_t* grays, const std::int32_t* noise, std::int32_t gain_256, std::size_t count,
               std::uint8_t* pixels) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t gray = ((grays[i] * gain_256) >> 8) + noise[i];
    pixels[i] = static_cast<std::uint8_t>(std::min(std::max((gray + 128) >> 8, 0), 255));
  }
}

}  // namespace

NoiseTable::NoiseTable(double sigma, double shot, double gamma)
    : even_(shot == 0.0 && gamma == 1.0), noiseless_(sigma == 0.0 && shot == 0.0) {
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
        static_cast<std::int32_t>(std::lround(255.0 * std::pow(static_cast<double>(i) / kWhite, 1.0 / gamma)));
}

void NoiseTable::expose(const std::uint16_t* grays, std::size_t size, double gain, std::uint64_t seed,
                        std::vector<std::uint8_t>& pixels) const {
  pixels.resize(size);
  const auto gain_256 = static_cast<std::int32_t>(std::lround(gain * 256.0));  // at most 10 * 256: see Imperfections
  if (even_) return expose_evenly(grays, size, gain_256, seed, pixels);
  std::array<std::uint64_t, 1024> numbers;
  for (std::size_t begin = 0; begin < size; begin += numbers.size()) {
    const std::size_t count = std::min(numbers.size(), size - begin);
    draw_numbers(seed, begin, count, numbers.data());
    add_shot_noise(grays + begin, table_.data(), numbers.data(), (1U << kBits) - 1U, scale_.data(), response_.data(),
                   gain_256, count, pixels.data() + begin);
  }
}

void NoiseTable::expose_evenly(const std::uint16_t* grays, std::size_t size, std::int32_t gain_256, std::uint64_t seed,
                               std::vector<std::uint8_t>& pixels) const {
  if (noiseless_) {
    for (std::size_t i = 0; i < size; ++i)
      pixels[i] = static_cast<std::uint8_t>(std::min((((grays[i] * gain_256) >> 8) + 128) >> 8, 255));
    return;
  }
  constexpr std::size_t per_number = 64 / kBits;
  constexpr std::uint64_t mask = (1U << kBits) - 1U;
  std::array<std::uint64_t, 400> numbers;
  std::array<std::int32_t, numbers.size() * per_number> noise;  // looked up one by one: gathering is no faster
  for (std::size_t begin = 0; begin < size; begin += noise.size()) {
    const std::size_t count = std::min(noise.size(), size - begin);
    draw_numbers(seed, begin / per_number, numbers.size(), numbers.data());
    for (std::size_t i = 0; i < numbers.size(); ++i)
      for (std::size_t k = 0; k < per_number; ++k)
        noise[i * per_number + k] = table_[(numbers[i] >> (k * kBits)) & mask];
    add_noise(grays + begin, noise.data(), gain_256, count, pixels.data() + begin);
  }
}

}  // namespace pilotfish::sim
