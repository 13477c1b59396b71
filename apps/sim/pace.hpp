#pragma once

#include <chrono>

namespace pilotfish::apps {

constexpr double kResendAfter_s = 0.05;  ///< what has not been answered

inline double monotonic_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace pilotfish::apps
