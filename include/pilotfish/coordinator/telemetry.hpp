#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/coordinator/coordinator.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// What the loop measured around one step.
struct StepTiming {
  double processing_s = 0.0;      ///< spent in step()
  double latency_s = 0.0;         ///< from the frame's arrival to its command
  double frame_rate_hz = 0.0;     ///< of the frames that arrived, smoothed
  double median_latency_s = 0.0;  ///< to the command, over the last frames
  bool from_exposure = false;     ///< that one; else from the arrival
};

/// The names used in the rows of core/telemetry.hpp; null where this frame has none.
struct TelemetrySources {
  const StepResult* step;                 ///< always there
  const Observation* seen;                ///< the leader, if it was measured
  const control::FollowerOutput* output;  ///< if the law ran
  const control::VelocityCommand* law;    ///< the fuzzy law's answer
  const control::LeaderMotion* leader;    ///< if the leader's motion is known
  const control::DriveEstimate* drive;    ///< if the law uses a model of the drive
  const StepTiming* timing;               ///< if it was measured
};
/// Valid as long as the arguments.
TelemetrySources telemetry_sources(const StepResult& step, const StepTiming* timing) noexcept;

/// Of a field: nothing, a number, a text (that of an enumeration; static), or a list with one element a tag.
using TelemetryValue =
    std::variant<std::monostate, bool, std::int64_t, double, std::string_view, std::vector<std::int64_t>,
                 std::vector<double>, std::vector<std::array<std::array<double, 2>, 4>>>;

/// A field of what is reported of a frame.
struct TelemetryField {
  const char* name;  ///< with its unit, as in JSON
  const char* unit;  ///< e.g. "m/s"; empty: it has none
  const char* text;  ///< what it is
  /// In that frame; nothing where it was not measured. `timing` may be null.
  TelemetryValue (*value)(const StepResult& step, const StepTiming* timing);
};

/// What is reported of a frame, in the order of a JSON line: the rows of core/telemetry.hpp.
const std::vector<TelemetryField>& telemetry_fields();

}  // namespace pilotfish
PILOTFISH_API_END
