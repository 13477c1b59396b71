#pragma once

#include <cstdint>
#include <string_view>

namespace pilotfish::sim {

/// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014): 64 bits of
/// state, every seed is good, and the same numbers on every platform, which std's distributions do not promise.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15ULL;
  /// The number that belongs to a state: the i-th of a seed, i = 1, 2, ..., is mixed(seed + i * kStep).
  static constexpr std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  std::uint64_t next() { return mixed(state_ += kStep); }
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// With mean 0 and variance 1, the sum of twelve: nearly Gaussian, never beyond 6, the same on every platform.
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }
  /// In [low, high], both included; the bias of the remainder is below 1e-15 for the small ranges used here.
  int integer(int low, int high) { return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1)); }

 private:
  std::uint64_t state_;
};

/// Another seed for another purpose: seed_for(seed_for(seed, "noise"), frame).
inline std::uint64_t seed_for(std::uint64_t seed, std::uint64_t number) {
  return Random(seed ^ Random(number + 1).next()).next();
}
inline std::uint64_t seed_for(std::uint64_t seed, std::string_view word) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;  // FNV-1a
  for (char letter : word) hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001B3ULL;
  return seed_for(seed, hash);
}

}  // namespace pilotfish::sim
