#pragma once

#include <optional>

#include "control_loop.hpp"
#include "stage_times.hpp"
#include "summary.hpp"
#include "translate.hpp"

namespace pilotfish::apps {

/// What leaves the program besides commands: observation, status, log, JSON.
class Reporter {
 public:
  Reporter(const LoopConfig& config, const LoopParts& parts, const Coordinator& coordinator)
      : summary(config.summary), config_(config), parts_(parts), coordinator_(coordinator) {}

  /// result: with the command that the sender really sent.
  void report(const StepResult& result, const StepTiming& timing);
  void print(const StepResult& result, const StepTiming& timing) const;

  Counters refused;  ///< by the loop itself
  std::int64_t setpoint_counter = 0;
  ImageView picture;  ///< the last one's size; its pixels may be gone
  StageTimes waited, looked, answered;
  Summary summary;

 private:
  bus::StatusReport status(const StepResult& result, const StepTiming& timing) const;
  static bus::MotionReport intent(const StepResult& result);
  std::string detail(const StepResult& result) const;
  void warn_of_losses();
  void log_change(const StepResult& result, const std::string& detail);

  const LoopConfig& config_;
  const LoopParts& parts_;
  const Coordinator& coordinator_;
  std::optional<std::pair<Status, Reason>> logged_;
  bool warned_of_losses_ = false;
};

}  // namespace pilotfish::apps
