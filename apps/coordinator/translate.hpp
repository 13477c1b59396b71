#pragma once

#include <string>

#include "pilotfish/bus/reports.hpp"
#include "pilotfish/coordinator/coordinator.hpp"

namespace pilotfish::apps {

/// What the loop measured around one step.
struct StepTiming {
  double processing_s = 0.0;      ///< spent in step()
  double latency_s = 0.0;         ///< from the frame's arrival to its command
  double frame_rate_hz = 0.0;     ///< of the frames that arrived, smoothed
  double median_latency_s = 0.0;  ///< to the command, over the last frames
  bool from_exposure = false;     ///< that one; else from the arrival
};

bus::ObservationReport observation_report(const StepResult& result, const StepTiming& timing);
bus::StatusReport status_report(const StepResult& result, const Coordinator& coordinator, const StepTiming& timing,
                                const std::map<std::string, std::int64_t>& rejected_by_bus);

/// One JSON object for one frame, without a line feed; null where nothing was measured.
std::string json_line(const StepResult& result, const StepTiming& timing);

}  // namespace pilotfish::apps
