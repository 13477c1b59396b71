#pragma once

#include <string>

#include "control_loop.hpp"
#include "pilotfish/bus/reports.hpp"
#include "pilotfish/coordinator/telemetry.hpp"

namespace pilotfish::apps {

bus::ObservationReport observation_report(const StepResult& result, const StepTiming& timing);

/// The parts of a status about the program rather than a frame; the rows of core/telemetry.hpp use these names.
struct LoopSources {
  const LoopConfig& config;
  const Coordinator& coordinator;
  const SenderCounts& sender;
  std::int64_t setpoint_counter;  ///< of the last one accepted
};
/// Without stages; `refused_elsewhere`: by others than the vision.
bus::StatusReport status_report(const StepResult& result, const StepTiming& timing, const LoopSources& loop,
                                const bus::Counters& refused_elsewhere);

/// One JSON object for one frame, without a line feed; null where nothing was measured.
std::string json_line(const StepResult& result, const StepTiming& timing);

}  // namespace pilotfish::apps
