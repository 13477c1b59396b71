#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pilotfish::sim {

/// White Gaussian noise by table: 4096 quantiles of the normal distribution, each as likely as the others,
/// scaled to unit variance exactly. It ends at 3.7 sigma. Five values come from one 64-bit random number, so
/// a picture takes a fraction of a millisecond, and it is the same picture on every platform.
class NoiseTable {
 public:
  explicit NoiseTable(double sigma);
  /// pixels[i] = clip(grays[i] / 256 * gain + noise), rounded to the nearest gray level.
  void expose(const std::vector<std::uint16_t>& grays, double gain, std::uint64_t seed,
              std::vector<std::uint8_t>& pixels) const;

 private:
  static constexpr int kBits = 12;
  std::array<std::int32_t, 1 << kBits> table_;  ///< in 1/256 gray levels
};

}  // namespace pilotfish::sim
