#pragma once

#include <cstdint>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// A leader that is lost is searched by turning in place. The one exception from the rule that nothing moves without a
/// fresh measurement of the leader, off by default: see docs/decisions/0051.
struct SearchConfig {
  PILOTFISH_PARAMETERS(SearchConfig);
  PILOTFISH_PARAMETER_WITHOUT_RANGE(
      bool, search_by_rotating, false,
      "true: turns in place to find a leader that was lost, never otherwise moving; only while pictures come and the "
      "ranges are fresh all around (control.avoidance.enabled)");
  PILOTFISH_PARAMETER(double, turn_rate_radps, 0.6, 0.01, 2.0, "with which it turns");
  PILOTFISH_PARAMETER(double, sweep_rad, radians(60.0), radians(5.0), radians(180.0),
                      "so far beyond where the leader was last seen, and then so far to the other side");
  PILOTFISH_PARAMETER(int, max_retries, 2, 0, 100, "how often it does so again before it gives up");
  PILOTFISH_PARAMETER(double, after_s, 0.3, 0.0, 60.0, "a leader that is hidden for less is waited for");
};

/// What the search answers.
struct SearchOutput {
  bool turning = false;          ///< else there is nothing to be done
  Reason reason = Reason::none;  ///< turning_to_search, or why it may not turn
  double angular_radps = 0.0;    ///< turn rate, positive: to the left
};

/// The turns: beyond where the leader was last seen, back and as far beyond on the other side, and home again, 1 +
/// max_retries times. Headings in any frame that stays.
class LeaderSearch {
 public:
  explicit LeaderSearch(const SearchConfig& config) : config_(config) {}  ///< no leader was seen yet

  /// The leader was measured at utime [us], in that direction.
  void seen(std::int64_t utime, double direction_rad) noexcept;
  /// The turn rate at utime [us] for a robot that looks along heading_rad; 0: it waits still, or has given up.
  double turn_rate(std::int64_t utime, double heading_rad) noexcept;
  void restart() noexcept;  ///< the leader has not been seen

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.seen_utime_, self.direction_rad_, self.side_, self.turns_);
  }

 private:
  SearchConfig config_;
  std::optional<std::int64_t> seen_utime_;
  double direction_rad_ = 0.0;  ///< in which the leader was seen
  double side_ = 0.0;           ///< to which the first turn goes; 0: none yet
  std::int64_t turns_ = 0;      ///< that were completed
};

}  // namespace pilotfish::control
PILOTFISH_API_END
