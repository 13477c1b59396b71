#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pilotfish::sim {

/// How gray levels, linear in the light, become the pixels of a sensor: noise, then its response.
///
/// White Gaussian noise by table: 4096 quantiles of the normal distribution, each as likely as the others,
/// scaled to unit variance exactly. It ends at 3.7 sigma. Five values come from one 64-bit random number, so
/// a picture takes a fraction of a millisecond, and it is the same picture on every platform.
class NoiseTable {
 public:
  /// Gray levels at gray 0 and what is added at gray 255: variance sigma^2 + shot^2 gray / 255. gamma: of the response.
  explicit NoiseTable(double sigma, double shot = 0.0, double gamma = 1.0);
  /// pixels[i] = response(clip(grays[i] / 256 * gain + noise)), rounded to the nearest gray level.
  void expose(const std::uint16_t* grays, std::size_t size, double gain, std::uint64_t seed,
              std::vector<std::uint8_t>& pixels) const;

 private:
  static constexpr int kBits = 12;
  void expose_evenly(const std::uint16_t* grays, std::size_t size, std::int32_t gain_256, std::uint64_t seed,
                     std::vector<std::uint8_t>& pixels) const;

  std::array<std::int32_t, 1 << kBits> table_;  ///< in 1/256 gray levels
  bool even_;                                   ///< the same noise at every gray, and a linear response
  bool noiseless_;                              ///< no noise at all
  std::array<std::int32_t, 256> scale_;         ///< of the noise at that gray over the table's, in 1/256
  std::vector<std::int32_t> response_;          ///< by the gray in 1/16
};

}  // namespace pilotfish::sim
