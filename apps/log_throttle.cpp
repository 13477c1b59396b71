#include "log_throttle.hpp"

namespace pilotfish::apps {

std::optional<std::int64_t> LogThrottle::due(const std::string& kind, MonotonicTime now) {
  const auto [entry, is_new] = kinds_.try_emplace(kind, Kind{now, 0});
  Kind& known = entry->second;
  if (!is_new && now.us - known.last.us < period_us_) {
    ++known.kept_back;
    return std::nullopt;
  }
  const std::int64_t kept_back = known.kept_back;
  known = {now, 0};
  return kept_back;
}

std::string kept_back_text(std::int64_t count) {
  return count == 0 ? "" : " (" + std::to_string(count) + " more like this were not logged)";
}

}  // namespace pilotfish::apps
