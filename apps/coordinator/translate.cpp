#include "translate.hpp"

#include <nlohmann/json.hpp>
#include <type_traits>

#include "pilotfish/core/telemetry.hpp"

namespace pilotfish::apps {

bus::ObservationReport observation_report(const StepResult& result, const StepTiming& timing) {
  return {result.utime, result.observation, result.reason, timing.latency_s};
}

namespace {

void fill_from_frame(const StepResult& result, const StepTiming& measured, bus::StatusReport& report) {
  const auto [step, seen, output, law, leader, drive, timing] = telemetry_sources(result, &measured);
#define PILOTFISH_FRAME_FIELD(type, name, unit, source, value, text) \
  if ((source) != nullptr) report.name = static_cast<type>(value);
#define PILOTFISH_LOOP_FIELD(type, name, unit, value, text)
  PILOTFISH_STATUS_FIELDS(PILOTFISH_FRAME_FIELD, PILOTFISH_LOOP_FIELD)
#undef PILOTFISH_LOOP_FIELD
#undef PILOTFISH_FRAME_FIELD
  if (law != nullptr) report.strengths = law->inference.strengths;
}

void fill_from_loop(const LoopSources& loop, const StepTiming& timing, bus::StatusReport& report) {
  const auto& [config, coordinator, sender, setpoint_counter] = loop;
#define PILOTFISH_FRAME_FIELD(type, name, unit, source, value, text)
#define PILOTFISH_LOOP_FIELD(type, name, unit, value, text) report.name = value;
  PILOTFISH_STATUS_FIELDS(PILOTFISH_FRAME_FIELD, PILOTFISH_LOOP_FIELD)
#undef PILOTFISH_LOOP_FIELD
#undef PILOTFISH_FRAME_FIELD
}

nlohmann::ordered_json as_json(const TelemetryValue& value) {
  return std::visit(
      [](const auto& said) -> nlohmann::ordered_json {
        using Said = std::decay_t<decltype(said)>;
        if constexpr (std::is_same_v<Said, std::monostate>)
          return nullptr;
        else if constexpr (std::is_same_v<Said, std::string_view>)
          return std::string(said);
        else
          return said;
      },
      value);
}

}  // namespace

bus::StatusReport status_report(const StepResult& result, const StepTiming& timing, const LoopSources& loop,
                                const bus::Counters& refused_elsewhere) {
  static_assert(bus::kStatusRules == fuzzy::kPaperRules);
  bus::StatusReport report;
  report.utime = result.utime;
  report.status = result.status;
  report.reason = result.reason;
  fill_from_frame(result, timing, report);
  fill_from_loop(loop, timing, report);
  report.setpoint = loop.coordinator.setpoint();
  report.rejected = refused_elsewhere;
  const vision::RejectionCounters& rejected = loop.coordinator.rejected();
  for (const vision::RejectionCounters::Named& each : vision::RejectionCounters::all())
    if (rejected.*each.count > 0) report.rejected[each.name] = rejected.*each.count;
  return report;
}

std::string json_line(const StepResult& result, const StepTiming& timing) {
  nlohmann::ordered_json json;
  for (const TelemetryField& field : telemetry_fields()) json[field.name] = as_json(field.value(result, &timing));
  return json.dump();
}

}  // namespace pilotfish::apps
