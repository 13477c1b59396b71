#include "latency_watch.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

namespace pilotfish::apps {

void LatencyWatch::answered(const Arrival& arrival, const FrameClock& clock, StepTiming& timing) {
  const auto now = MonotonicClock::now();
  timing.latency_s = std::chrono::duration<double>(now - arrival.at).count();
  const std::optional<double> since_exposure_s = clock.since_exposure_s(arrival, now);
  last_[next_] = since_exposure_s.value_or(timing.latency_s);
  next_ = (next_ + 1) % kFrames;
  count_ = std::min(count_ + 1, kFrames);
  timing.median_latency_s = median_s();
  timing.from_exposure = since_exposure_s.has_value();
  if (timing.from_exposure && count_ == kFrames && !config_.every_frame) warn_once(timing.median_latency_s);
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
