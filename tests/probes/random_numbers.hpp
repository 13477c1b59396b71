#pragma once

#include <cstdint>
#include <random>

namespace pilotfish::probes {

/// Seeded, and the same numbers on every compiler: std::mt19937_64 is prescribed bit by bit, std's distributions are
/// not.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  /// In [low, high).
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits() >> 11U) * 0x1p-53; }
  /// 0 to count - 1.
  int below(int count) { return static_cast<int>(bits() % static_cast<std::uint64_t>(count)); }
  bool once_in(int count) { return below(count) == 0; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace pilotfish::probes
