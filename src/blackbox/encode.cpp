#include "encode.hpp"

#include <bot_core/image_t.hpp>
#include <pilotfish/box_start_t.hpp>
#include <pilotfish/sent_t.hpp>
#include <pilotfish/step_t.hpp>

#include "pilotfish/jpeg/jpeg.hpp"

namespace pilotfish::blackbox {
namespace {

template <class Message>
Bytes bytes_of(const Message& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

template <int Rows, int Columns, class Matrix>
void fill(double (&out)[Rows][Columns], const Matrix& matrix) {
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column) out[row][column] = matrix(row, column);
}

held_t message_of(const HeldCommand& held) {
  held_t message{};
  message.utime = held.utime;
  message.linear_mps = held.command.linear_mps;
  message.angular_radps = held.command.angular_radps;
  message.from_us = held.from.us;
  message.until_us = held.until.us;
  message.holding = held.holding;
  message.run = held.run;
  message.ever_measured = held.ever_measured;
  message.turning = held.turning;
  return message;
}

measured_tag_t message_of(const TagDetection& tag) {
  measured_tag_t message{};
  message.id = tag.id;
  message.hamming = tag.hamming;
  message.decision_margin = tag.decision_margin;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 2; ++k) message.corners_px[i][k] = tag.corners_px[i][k];
  return message;
}

measurement_t message_of(const Observation& observation) {
  measurement_t message{};
  message.utime = observation.utime;
  message.distance_m = observation.distance_m;
  message.bearing_rad = observation.bearing_rad;
  message.heading_rad = observation.heading_rad;
  fill(message.covariance, observation.covariance);
  message.heading_ambiguity = observation.heading_ambiguity;
  message.measured_distance_m = observation.measured.pose.distance_m;
  message.measured_bearing_rad = observation.measured.pose.bearing_rad;
  message.measured_heading_rad = observation.measured.pose.heading_rad;
  fill(message.measured_covariance, observation.measured.covariance);
  fill(message.camera_from_leader, observation.cMo.matrix());
  if (observation.other_cMo)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        message.other_camera_from_leader.push_back(observation.other_cMo->matrix()(row, column));
  message.other_count = static_cast<std::int32_t>(message.other_camera_from_leader.size());
  message.ambiguity_ratio = observation.ambiguity_ratio;
  message.reprojection_error_px = observation.reprojection_error_px;
  message.min_decision_margin = observation.min_decision_margin;
  message.found_by = static_cast<std::int8_t>(observation.found_by);
  for (const TagDetection& tag : observation.tags) message.tags.push_back(message_of(tag));
  message.tag_count = static_cast<std::int32_t>(message.tags.size());
  return message;
}

step_t message_of(std::int64_t sequence, const Call& call, const HeldCommand& held) {
  step_t message{};
  message.sequence = sequence;
  message.kind = call.kind;
  message.now_us = call.now_us;
  message.utime = call.utime;
  message.known_age_us = call.known_age_us;
  message.coarse_search = call.coarse_search;
  for (std::size_t i = 0; i < call.in_view.size(); ++i) message.leaders_in_view |= call.in_view[i] ? 1 << i : 0;
  message.distance_m = call.setpoint.distance_m;
  message.bearing_rad = call.setpoint.bearing_rad;
  message.run = call.setpoint.run;
  message.linear_mps = call.twist.linear_mps;
  message.angular_radps = call.twist.angular_radps;
  if (call.scan != nullptr) {
    message.first_rad = call.scan->first_rad;
    message.step_rad = call.scan->step_rad;
    message.ranges_m.assign(call.scan->ranges_m.begin(), call.scan->ranges_m.end());
    message.range_count = static_cast<std::int32_t>(message.ranges_m.size());
  }
  message.held = message_of(held);
  return message;
}

box_file_t message_of(const config::ConfigText& file) {
  box_file_t message;
  message.role = file.role;
  message.name = file.name;
  message.data.assign(file.text.begin(), file.text.end());
  message.size = static_cast<std::int32_t>(message.data.size());
  return message;
}

}  // namespace

Bytes encode_frame(std::int64_t sequence, const Call& call, const StepResult& result, const HeldCommand& held) {
  step_t message = message_of(sequence, call, held);
  if (result.observation) message.measurement.push_back(message_of(*result.observation));
  message.measured = static_cast<std::int32_t>(message.measurement.size());
  message.taken = 1;
  message.status = static_cast<std::int8_t>(result.status);
  message.reason = static_cast<std::int8_t>(result.reason);
  message.command_linear_mps = result.command.linear_mps;
  message.command_angular_radps = result.command.angular_radps;
  return bytes_of(message);
}

Bytes encode_call(std::int64_t sequence, const Call& call, bool taken, const HeldCommand& held) {
  step_t message = message_of(sequence, call, held);
  message.taken = taken;
  return bytes_of(message);
}

Bytes encode_sent(const HeldCommand& held, MonotonicTime now, Reason missing, const HeldAnswer& sent,
                  std::int64_t session, std::int64_t counter) {
  sent_t message{};
  message.now_us = now.us;
  message.held = message_of(held);
  message.missing = static_cast<std::int8_t>(missing);
  message.session = session;
  message.counter = counter;
  message.status = static_cast<std::int8_t>(sent.status);
  message.reason = static_cast<std::int8_t>(sent.reason);
  message.linear_mps = sent.command.linear_mps;
  message.angular_radps = sent.command.angular_radps;
  return bytes_of(message);
}

Bytes encode_start(const Start& start, const Instant& instant, std::int64_t sequence, const Counters& counters,
                   const CoordinatorMemory& memory) {
  box_start_t message{};
  message.utime = instant.utime;
  message.now_us = instant.now.us;
  message.session = start.session;
  message.program = program_description();
  message.robot = start.robot;
  message.command_line = start.command_line;
  message.sequence = sequence;
  message.dropped = counters.dropped;
  message.lost = counters.lost;
  for (const config::ConfigText& file : start.config.files) message.files.push_back(message_of(file));
  message.file_count = static_cast<std::int32_t>(message.files.size());
  const config::ConfigOverrides& overrides = start.config.overrides;
  if (overrides.law) message.overrides.push_back("law=" + *overrides.law);
  if (overrides.profile) message.overrides.push_back("profile=" + *overrides.profile);
  message.override_count = static_cast<std::int32_t>(message.overrides.size());
  message.decisions = memory.decisions;
  message.decisions_size = static_cast<std::int32_t>(memory.decisions.size());
  message.vision = memory.vision;
  message.vision_size = static_cast<std::int32_t>(memory.vision.size());
  return bytes_of(message);
}

Bytes encode_copy(const Frame& frame) {
  if (check(frame.image) != Reason::none) return {};
  bot_core::image_t message{};
  message.data = jpeg::encode(frame.image);
  if (message.data.empty()) return {};
  message.utime = frame.utime;
  message.width = message.row_stride = frame.image.width;
  message.height = frame.image.height;
  message.pixelformat = bot_core::image_t::PIXEL_FORMAT_MJPEG;
  message.size = static_cast<std::int32_t>(message.data.size());
  bot_core::image_metadata_t copy;
  copy.key = "pilotfish_copy";
  copy.n = 0;
  message.metadata.push_back(std::move(copy));
  message.nmetadata = 1;
  return bytes_of(message);
}

Bytes encode_raw(const Frame& frame) {
  const ImageView& image = frame.image;
  if (check(image) != Reason::none) return {};
  bot_core::image_t message{};
  message.utime = frame.utime;
  message.width = message.row_stride = image.width;
  message.height = image.height;
  message.pixelformat = bot_core::image_t::PIXEL_FORMAT_GRAY;
  message.data.reserve(static_cast<std::size_t>(image.width) * image.height);
  for (int row = 0; row < image.height; ++row) {
    const std::uint8_t* first = image.data + static_cast<std::size_t>(image.stride_bytes) * row;
    message.data.insert(message.data.end(), first, first + image.width);
  }
  message.size = static_cast<std::int32_t>(message.data.size());
  return bytes_of(message);
}

}  // namespace pilotfish::blackbox
