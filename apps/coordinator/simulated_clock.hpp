#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::apps {

/// Time for frames that were not taken now: a simulator in lock-step, a recording, a folder of pictures. It passes as
/// the stamps say, so that a run depends on nothing but its pictures; where a stamp is unusable (it goes back, or
/// leaps by more than an hour), it passes in real time. Its use is marked in every command, and real wheels
/// refuse those.
class SimulatedClock {
 public:
  /// The simulated time at which the frame stamped `utime` arrives.
  MonotonicTime at(std::int64_t utime, MonotonicTime real) {
    if (last_utime_) {
      const double passed_us = static_cast<double>(utime) - static_cast<double>(*last_utime_);
      const bool plausible = passed_us >= 0.0 && passed_us <= kLeap_us;
      now_.us += plausible ? static_cast<std::int64_t>(passed_us) : std::max<std::int64_t>(real.us - last_real_.us, 0);
    }
    last_utime_ = utime;
    last_real_ = real;
    return now_;
  }
  /// What it shows; it stands still until the next frame.
  MonotonicTime now() const { return now_; }

 private:
  static constexpr double kLeap_us = 3600e6;
  std::optional<std::int64_t> last_utime_;
  MonotonicTime now_, last_real_;
};

}  // namespace pilotfish::apps
