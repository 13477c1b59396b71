#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::apps {

/// Limits log lines, so that a flood of events is not a flood of lines: of each kind the first at once, then at
/// most one a period, with the number of those suppressed. Kinds are few and the program's own, never a text from a
/// sender.
class LogThrottle {
 public:
  explicit LogThrottle(double period_s) : period_us_(static_cast<std::int64_t>(period_s * 1e6)) {}

  /// Something of that kind happened now. The number suppressed since the last line if a line is due, else nothing.
  std::optional<std::int64_t> due(const std::string& kind, MonotonicTime now);

 private:
  struct Kind {
    MonotonicTime last;
    std::int64_t kept_back = 0;
  };
  std::int64_t period_us_;
  std::map<std::string, Kind> kinds_;
};

/// "" or " (48000 more like this were not logged)".
std::string kept_back_text(std::int64_t count);

}  // namespace pilotfish::apps
