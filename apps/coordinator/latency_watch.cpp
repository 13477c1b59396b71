#include "latency_watch.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

namespace pilotfish::apps {

void LatencyWatch::answered(double since_arrival_s, std::int64_t known_age_us, StepTiming& timing) {
  timing.latency_s = since_arrival_s;
  timing.from_exposure = known_age_us > 0;
  last_[next_] = since_arrival_s + std::max(static_cast<double>(known_age_us) * 1e-6, 0.0);
  next_ = (next_ + 1) % kFrames;
  count_ = std::min(count_ + 1, kFrames);
  timing.median_latency_s = median_s();
  if (timing.from_exposure && count_ == kFrames && !config_.simulated) warn_once(timing.median_latency_s);
}

double LatencyWatch::median_s() const {
  std::array<double, kFrames> sorted = last_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count_ / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count_));
  return *middle;
}

void LatencyWatch::warn_once(double median_latency_s) {
  if (warned_ || std::abs(median_latency_s - config_.configured_latency_s) <= 1.0 / config_.frame_rate_hz) return;
  warned_ = true;
  spdlog::warn(
      "from exposure to command takes {:.0f} ms; control.drive.latency_s, which also holds the wheel driver's "
      "share, says {:.0f} ms",
      median_latency_s * 1e3, config_.configured_latency_s * 1e3);
}

}  // namespace pilotfish::apps
