#include "status_codec.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "encoding.hpp"

namespace pilotfish::bus {
namespace {

static_assert(static_cast<int>(BaseReport::State::waiting) == base_t::STATE_WAITING);
static_assert(static_cast<int>(BaseReport::State::driving) == base_t::STATE_DRIVING);
static_assert(static_cast<int>(BaseReport::State::stopped) == base_t::STATE_STOPPED);
static_assert(static_cast<int>(BaseReport::State::fault) == base_t::STATE_FAULT);

constexpr std::size_t kStageCounts = std::tuple_size_v<decltype(StageReport::counts)>;

/// The space for the list of counters in a message that is otherwise complete.
template <class Message>
std::size_t room_left(const Message& message) {
  const auto taken = static_cast<std::size_t>(message.getEncodedSize());
  return taken < kOneDatagramBytes ? kOneDatagramBytes - taken : 0;
}

stage_t encode(const StageReport& stage, FiniteOrZero& finite) {
  stage_t message{};
  message.name = stage.name.substr(0, kMaxStageName);
  std::copy(stage.counts.begin(), stage.counts.end(), message.counts);
  message.max_ms = finite(stage.max_ms);
  return message;
}

// A row of PILOTFISH_STATUS_FIELDS without the source of its value.
#define PILOTFISH_FRAME_FIELD(type, name, unit, source, value, text) PILOTFISH_FIELD(type, name)
#define PILOTFISH_LOOP_FIELD(type, name, unit, value, text) PILOTFISH_FIELD(type, name)
#define PILOTFISH_ALL_FIELDS PILOTFISH_STATUS_FIELDS(PILOTFISH_FRAME_FIELD, PILOTFISH_LOOP_FIELD)

/// LCM has no type of its own for bool.
template <class Value>
using Wire = std::conditional_t<std::is_same_v<Value, bool>, std::int8_t, Value>;

// NOLINTBEGIN(bugprone-macro-parentheses): a type cannot stand in parentheses.
#define PILOTFISH_FIELD(type, name) \
  static_assert(std::is_same_v<decltype(status_t::name), Wire<type>>, "not of that type in pilotfish_status_t.lcm");
PILOTFISH_ALL_FIELDS
#undef PILOTFISH_FIELD
// NOLINTEND(bugprone-macro-parentheses)

std::size_t size_of_numbers() {
  std::size_t sum = 0;
  StatusReport::fields([&sum](const StatusField&, auto member) {
    sum += sizeof(Wire<std::decay_t<decltype(std::declval<StatusReport>().*member)>>);
  });
  return sum;
}

bool is_sound_status(const void* data, std::size_t size_bytes) {
  WireReader reader(data, size_bytes);
  constexpr std::size_t kBeforeText = 8 /* fingerprint */ + 8 + 2;
  constexpr std::size_t kSetpoint = 8 + 8 + 1;
  std::int32_t stages = 0;
  if (!reader.skip(kBeforeText) || !reader.skip_string() || !reader.skip(size_of_numbers() + kSetpoint) ||
      !reader.read(stages) || stages < 0 || stages > static_cast<std::int32_t>(kMaxStages))
    return false;
  for (std::int32_t i = 0; i < stages; ++i)
    if (!reader.skip_string(kMaxStageName) || !reader.skip(kStageCounts * 4 + 8)) return false;
  return skip_counters(reader, kMaxCounters) && reader.skip(kStatusRules * 4) && reader.at_end();
}

bool is_sound_base(const void* data, std::size_t size_bytes) {
  WireReader reader(data, size_bytes);
  constexpr std::size_t kBeforeText = 8 /* fingerprint */ + 5 * 8 + 2 * 8 + (1 + 2 * 8) + 2;
  return reader.skip(kBeforeText) && reader.skip_string(kMaxBaseText) && skip_counters(reader, kMaxBaseCounters) &&
         reader.skip(sizeof(base_t::mac)) && reader.at_end();
}

bool all_finite(const StatusReport& report) {
  bool finite = std::isfinite(report.setpoint.distance_m) && std::isfinite(report.setpoint.bearing_rad);
  StatusReport::fields([&](const StatusField&, auto member) {
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(report.*member)>>)
      finite = finite && std::isfinite(report.*member);
  });
  return finite &&
         std::all_of(report.strengths.begin(), report.strengths.end(), [](double s) { return std::isfinite(s); }) &&
         std::all_of(report.stages.begin(), report.stages.end(),
                     [](const StageReport& stage) { return std::isfinite(stage.max_ms); });
}

}  // namespace

status_t encode(const StatusReport& report, std::string_view& repaired, std::size_t turn) {
  FiniteOrZero finite;
  status_t message{};
  message.utime = report.utime;
  message.status = static_cast<std::int8_t>(report.status);
  message.reason = static_cast<std::int8_t>(report.reason);
  message.text = words(report.status, report.reason);
  if (!report.detail.empty()) message.text += " (" + report.detail.substr(0, kMaxDetail) + ")";
#define PILOTFISH_FIELD(type, name) message.name = finite(report.name);
  PILOTFISH_ALL_FIELDS
#undef PILOTFISH_FIELD
  for (std::size_t i = 0; i < kStatusRules; ++i) message.strengths[i] = static_cast<float>(finite(report.strengths[i]));
  message.setpoint_distance_m = finite(report.setpoint.distance_m);
  message.setpoint_bearing_rad = finite(report.setpoint.bearing_rad);
  message.setpoint_run = report.setpoint.run;
  const std::size_t stages = std::min(report.stages.size(), kMaxStages);
  for (std::size_t i = 0; i < stages; ++i) message.stages.push_back(encode(report.stages[i], finite));
  message.stage_count = static_cast<std::int32_t>(stages);
  message.rejected = encode(report.rejected, kMaxCounters, room_left(message), turn);
  message.rejected_count = static_cast<std::int32_t>(message.rejected.size());
  if (finite.repaired) repaired = "status_not_finite";
  return message;
}

base_t encode(const BaseReport& report, std::string_view& repaired, std::size_t turn) {
  FiniteOrZero finite;
  base_t message{};
  message.utime = report.utime;
  message.session = report.session;
  message.counter = report.counter;
  message.monotonic_us = report.monotonic_us;
  message.accepted_session = report.accepted_session;
  message.linear_mps = finite(report.command.linear_mps);
  message.angular_radps = finite(report.command.angular_radps);
  const bool measured_finite = report.measured && is_finite(*report.measured);
  message.measured = measured_finite;
  message.measured_linear_mps = measured_finite ? report.measured->linear_mps : 0.0;
  message.measured_angular_radps = measured_finite ? report.measured->angular_radps : 0.0;
  message.stopped = report.stopped;
  message.state = static_cast<std::int8_t>(report.state);
  message.text = report.text.substr(0, kMaxBaseText);
  message.rejected = encode(report.rejected, kMaxBaseCounters, room_left(message), turn);
  message.rejected_count = static_cast<std::int32_t>(message.rejected.size());
  if (finite.repaired || (report.measured && !measured_finite)) repaired = "base_not_finite";
  return message;
}

Checked<StatusReport> decode_status(const void* data, std::size_t size_bytes) {
  using Result = Checked<StatusReport>;
  status_t message;
  if (!is_sound_status(data, size_bytes) || !decode_whole(message, data, size_bytes))
    return Result::reject("status_corrupt");
  if (!is_known(message.status, message.reason)) return Result::reject("status_out_of_bounds");
  StatusReport report;
  report.utime = message.utime;
  report.status = static_cast<Status>(message.status);
  report.reason = static_cast<Reason>(message.reason);
#define PILOTFISH_FIELD(type, name) report.name = static_cast<type>(message.name);
  PILOTFISH_ALL_FIELDS
#undef PILOTFISH_FIELD
  std::copy_n(message.strengths, kStatusRules, report.strengths.begin());
  report.setpoint = {message.setpoint_distance_m, message.setpoint_bearing_rad, message.setpoint_run != 0};
  for (const stage_t& stage : message.stages) {
    StageReport& decoded = report.stages.emplace_back();
    decoded.name = stage.name;
    std::copy_n(stage.counts, kStageCounts, decoded.counts.begin());
    decoded.max_ms = stage.max_ms;
  }
  report.rejected = decode(message.rejected);
  if (!all_finite(report)) return Result::reject("status_not_finite");
  return Result::accept(std::move(report));
}

Checked<BaseReport> decode_base(const void* data, std::size_t size_bytes, const Authentication& authentication) {
  using Result = Checked<BaseReport>;
  base_t message;
  if (!is_sound_base(data, size_bytes)) return Result::reject("base_corrupt");
  if (!authentication.is_right(data, size_bytes)) return Result::reject("base_mac_wrong");
  if (!decode_whole(message, data, size_bytes)) return Result::reject("base_corrupt");
  BaseReport report;
  report.utime = message.utime;
  report.session = message.session;
  report.counter = message.counter;
  report.monotonic_us = message.monotonic_us;
  report.accepted_session = message.accepted_session;
  report.command = {message.linear_mps, message.angular_radps};
  const Twist measured{message.measured_linear_mps, message.measured_angular_radps};
  if (!is_finite(report.command) || !is_finite(measured)) return Result::reject("base_not_finite");
  if (!is_plausible(report.command) || !is_plausible(measured) || !is_usable_time(message.monotonic_us) ||
      message.state < 0 || message.state > base_t::STATE_FAULT)
    return Result::reject("base_out_of_bounds");
  if (message.measured != 0) report.measured = measured;
  report.stopped = message.stopped != 0;
  report.state = static_cast<BaseReport::State>(message.state);
  report.text = message.text;
  report.rejected = decode(message.rejected);
  return Result::accept(std::move(report));
}

}  // namespace pilotfish::bus
