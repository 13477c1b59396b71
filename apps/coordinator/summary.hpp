#pragma once

#include <optional>
#include <string>

#include "pilotfish/bus/reports.hpp"
#include "pilotfish/coordinator/coordinator.hpp"

namespace pilotfish::apps {

/// One line about the last seconds, for whoever watches a terminal.
class Summary {
 public:
  static constexpr std::int64_t kEvery_us = 2'000'000;

  explicit Summary(bool wanted) : wanted_(wanted) {}

  /// answer_s: from the frame's arrival until the command left.
  void frame(const StepResult& result, double answer_s);
  /// The line, when it is due: `status` is the newest.
  std::optional<std::string> due(MonotonicTime now, const bus::StatusReport& status);

 private:
  std::string line(const bus::StatusReport& status, double seconds) const;
  std::string refused_since(const bus::Counters& counters) const;

  const bool wanted_;
  std::optional<MonotonicTime> since_;
  int frames_ = 0, measured_ = 0;
  double longest_answer_s_ = 0.0;
  std::optional<Observation> last_;
  Twist command_;
  bus::Counters refused_;  ///< as of the last line
};

}  // namespace pilotfish::apps
