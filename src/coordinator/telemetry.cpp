#include "pilotfish/coordinator/telemetry.hpp"

#include <type_traits>

#include "pilotfish/core/telemetry.hpp"

namespace pilotfish {
namespace {

using Corners = std::array<std::array<double, 2>, 4>;

std::vector<std::int64_t> tag_ids(const Observation* seen) {
  std::vector<std::int64_t> ids;
  if (seen != nullptr)
    for (const TagDetection& tag : seen->tags) ids.push_back(tag.id);
  return ids;
}

std::vector<double> decision_margins(const Observation* seen) {
  std::vector<double> margins;
  if (seen != nullptr)
    for (const TagDetection& tag : seen->tags) margins.push_back(tag.decision_margin);
  return margins;
}

std::vector<Corners> corners_px(const Observation* seen) {
  std::vector<Corners> all;
  if (seen != nullptr)
    for (const TagDetection& tag : seen->tags) {
      Corners& corners = all.emplace_back();
      for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = {tag.corners_px[i].x(), tag.corners_px[i].y()};
    }
  return all;
}

/// An enumeration as its text, anything else as it is.
template <class Value>
TelemetryValue as_value(Value value) {
  if constexpr (std::is_enum_v<Value>)
    return to_string(value);
  else
    return value;
}

}  // namespace

TelemetrySources telemetry_sources(const StepResult& step, const StepTiming* timing) noexcept {
  TelemetrySources sources{&step, nullptr, nullptr, nullptr, nullptr, nullptr, timing};
  if (step.observation) sources.seen = &*step.observation;
  if (step.control) {
    sources.output = &*step.control;
    sources.law = &step.control->velocity;
    if (step.control->leader) sources.leader = &*step.control->leader;
    if (step.control->drive) sources.drive = &*step.control->drive;
  }
  return sources;
}

const std::vector<TelemetryField>& telemetry_fields() {
// A name that a row does not use is no mistake.
#define PILOTFISH_FIELD(field, unit, source, what, text)                                                \
  {#field, unit, text, [](const StepResult& result, const StepTiming* measured) -> TelemetryValue {     \
     const auto [step, seen, output, law, leader, drive, timing] = telemetry_sources(result, measured); \
     if ((source) == nullptr) return {};                                                                \
     return as_value(what);                                                                             \
   }},
#define PILOTFISH_TYPED(type, field, unit, source, what, text) PILOTFISH_FIELD(field, unit, source, what, text)
#define PILOTFISH_NOT_OF_A_FRAME(type, field, unit, what, text)
  static const std::vector<TelemetryField> fields = {
      PILOTFISH_FRAME_FIELDS(PILOTFISH_FIELD) PILOTFISH_STATUS_FIELDS(PILOTFISH_TYPED, PILOTFISH_NOT_OF_A_FRAME)};
#undef PILOTFISH_NOT_OF_A_FRAME
#undef PILOTFISH_TYPED
#undef PILOTFISH_FIELD
  return fields;
}

}  // namespace pilotfish
