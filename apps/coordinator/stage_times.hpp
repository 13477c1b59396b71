#pragma once

#include <array>
#include <cstdint>

namespace pilotfish::apps {

/// How long one stage of the loop took, as a histogram: stage_t on the wire. One thread writes, or the caller locks.
class StageTimes {
 public:
  static constexpr std::size_t kBins = 11;

  void add(double seconds) {
    const double ms = seconds * 1e3;
    std::size_t bin = 0;
    for (double upper_ms = 0.25; bin < kBins - 1 && ms >= upper_ms; upper_ms *= 2.0) ++bin;
    ++counts_[bin];
    if (ms > max_ms_) max_ms_ = ms;
  }
  const std::array<std::int32_t, kBins>& counts() const { return counts_; }
  double max_ms() const { return max_ms_; }

 private:
  std::array<std::int32_t, kBins> counts_{};
  double max_ms_ = 0.0;
};

}  // namespace pilotfish::apps
