#pragma once

#include <array>
#include <cstddef>

#include "control_loop.hpp"
#include "translate.hpp"

namespace pilotfish::apps {

/// From a frame to the command that answers it: the median of the last frames, so that one late frame has no effect.
/// Logs once if the configured value differs: a horizon shorter than the loop's delay makes the command
/// oscillate.
class LatencyWatch {
 public:
  explicit LatencyWatch(const LoopConfig& config) : config_(config) {}

  /// since_arrival_s: until the command left. known_age_us: Frame's, from exposure to arrival; 0: unknown. Fills in the
  /// latencies of `timing`.
  void answered(double since_arrival_s, std::int64_t known_age_us, StepTiming& timing);

 private:
  double median_s() const;
  void warn_once(double median_latency_s);

  static constexpr std::size_t kFrames = 31;
  const LoopConfig& config_;
  std::array<double, kFrames> last_{};
  std::size_t next_ = 0, count_ = 0;
  bool warned_ = false;
};

}  // namespace pilotfish::apps
