#include "report_codec.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "encoding.hpp"
#include "wire_reader.hpp"

namespace pilotfish::bus {
namespace {

/// Finite also as the float it becomes on the wire.
bool fits_float(double value) { return std::isfinite(static_cast<float>(value)); }

bool all_finite(const TagDetection& tag) {
  return fits_float(tag.decision_margin) &&
         std::all_of(tag.corners_px.begin(), tag.corners_px.end(),
                     [](const Eigen::Vector2d& corner) { return fits_float(corner.x()) && fits_float(corner.y()); });
}

bool all_finite(const Observation& observation) {
  for (double value : {observation.distance_m, observation.bearing_rad, observation.heading_rad,
                       observation.reprojection_error_px, observation.ambiguity_ratio, observation.min_decision_margin})
    if (!std::isfinite(value)) return false;
  return observation.covariance.allFinite() && observation.cMo.matrix().allFinite() &&
         std::all_of(observation.tags.begin(), observation.tags.end(),
                     [](const TagDetection& tag) { return all_finite(tag); });
}

tag_detection_t encode(const TagDetection& tag) {
  tag_detection_t message{};
  message.id = tag.id;
  message.hamming = static_cast<std::int8_t>(tag.hamming);
  message.decision_margin = static_cast<float>(tag.decision_margin);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 2; ++k) message.corners_px[i][k] = static_cast<float>(tag.corners_px[i][k]);
  return message;
}

constexpr double kUnitWithin = 0.01;  // deviation from 1 by single precision and an inexact sender

bool is_sound_command(const void* data, std::size_t size_bytes) {
  WireReader reader(data, size_bytes);
  constexpr std::size_t kBeforeText = 8 /* fingerprint */ + 5 * 8 + 2 * 8 + 3, kMac = 32;
  return reader.skip(kBeforeText) && reader.skip_string() && reader.skip(kMac) && reader.at_end();
}

/// Python's lcm sends a mac that was not set as no bytes at all.
bool decode_without_mac(setpoint_t& message, const void* data, std::size_t size_bytes) {
  const auto whole = static_cast<std::size_t>(message.getEncodedSize());
  if (size_bytes != whole - sizeof(message.mac)) return false;
  std::vector<std::uint8_t> padded(whole);
  std::memcpy(padded.data(), data, size_bytes);
  return decode_whole(message, padded.data(), padded.size());
}

}  // namespace

command_t encode(const CommandReport& report, std::string_view& repaired) {
  const bool finite = is_finite(report.command);
  if (!finite) repaired = "command_not_finite";
  const Reason reason = finite ? report.reason : Reason::law_not_finite;
  command_t message{};
  message.utime = report.utime;
  message.session = report.session;
  message.counter = report.counter;
  message.base_session = report.base_session;
  message.valid_until_us = report.valid_until_us;
  message.simulated = report.simulated;
  message.linear_mps = finite ? report.command.linear_mps : 0.0;
  message.angular_radps = finite ? report.command.angular_radps : 0.0;
  message.status = static_cast<std::int8_t>(report.status);
  message.reason = static_cast<std::int8_t>(reason);
  message.text = words(report.status, reason);
  return message;
}

observation_t encode(const ObservationReport& report, std::string_view& repaired) {
  observation_t message{};
  message.utime = report.utime;
  message.reason = static_cast<std::int8_t>(report.reason);
  message.text = to_string(report.reason);
  message.latency_s = std::isfinite(report.latency_s) ? report.latency_s : 0.0;
  message.detected = report.observation && all_finite(*report.observation);
  if ((report.observation && !message.detected) || !std::isfinite(report.latency_s))
    repaired = "observation_not_finite";
  if (!message.detected) return message;

  const Observation& observation = *report.observation;
  message.distance_m = observation.distance_m;
  message.bearing_rad = observation.bearing_rad;
  message.heading_rad = observation.heading_rad;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) message.covariance[row][column] = observation.covariance(row, column);
    for (int column = 0; column < 4; ++column)
      message.camera_from_leader[row][column] = observation.cMo.matrix()(row, column);
  }
  message.reprojection_error_px = observation.reprojection_error_px;
  message.ambiguity_ratio = observation.ambiguity_ratio;
  message.min_decision_margin = observation.min_decision_margin;
  const std::size_t count = std::min(observation.tags.size(), kMaxTags);
  for (std::size_t i = 0; i < count; ++i) message.tags.push_back(encode(observation.tags[i]));
  message.tag_count = static_cast<std::int32_t>(count);
  return message;
}

bot_core::pose_t encode(const PoseReport& report, std::string_view& repaired) {
  FiniteOrZero finite;
  const double heading_rad = finite(report.heading_rad), speed_mps = finite(report.velocity.linear_mps);
  bot_core::pose_t message{};
  message.utime = report.utime;
  message.pos[0] = finite(report.x_m);
  message.pos[1] = finite(report.y_m);
  message.vel[0] = speed_mps * std::cos(heading_rad);
  message.vel[1] = speed_mps * std::sin(heading_rad);
  // A turn by the heading about z, as a quaternion: w = cos(h/2), z = sin(h/2).
  message.orientation[0] = std::cos(heading_rad / 2.0);
  message.orientation[3] = std::sin(heading_rad / 2.0);
  message.rotation_rate[2] = finite(report.velocity.angular_radps);
  if (finite.repaired) repaired = "pose_not_finite";
  return message;
}

std::optional<motion_t> encode(const MotionReport& report) {
  if (!is_finite(report.twist)) return std::nullopt;
  motion_t message;
  message.utime = report.utime;
  message.linear_mps = report.twist.linear_mps;
  message.angular_radps = report.twist.angular_radps;
  return message;
}

setpoint_t encode(const SetpointReport& report) {
  setpoint_t message{};
  message.utime = report.utime;
  message.session = report.session;
  message.counter = report.counter;
  message.distance_m = report.setpoint.distance_m;
  message.bearing_rad = report.setpoint.bearing_rad;
  message.run = report.setpoint.run;
  return message;
}

Checked<SetpointReport> decode_setpoint(const void* data, std::size_t size_bytes,
                                        const Authentication& authentication) {
  using Result = Checked<SetpointReport>;
  setpoint_t message{};
  // No fault in a stop message is a reason for the robot to go on.
  const auto refuse = [&message](std::string_view rejection) {
    SetpointReport bare_stop;
    bare_stop.utime = message.utime;
    bare_stop.setpoint.run = false;
    return message.run == 0 ? Result::repair(bare_stop, rejection) : Result::reject(rejection);
  };
  if (!decode_whole(message, data, size_bytes))
    return decode_without_mac(message, data, size_bytes) ? refuse("setpoint_corrupt")
                                                         : Result::reject("setpoint_corrupt");
  if (!authentication.is_right(data, size_bytes)) return refuse("setpoint_mac_wrong");
  const Setpoint setpoint{message.distance_m, message.bearing_rad, message.run != 0};
  if (!std::isfinite(setpoint.distance_m) || !std::isfinite(setpoint.bearing_rad)) return refuse("setpoint_not_finite");
  try {
    check_ranges(setpoint, "setpoint");
  } catch (const ConfigError&) {
    return refuse("setpoint_out_of_bounds");
  }
  return Result::accept({message.utime, message.session, message.counter, setpoint});
}

Checked<CommandReport> decode_command(const void* data, std::size_t size_bytes, const Authentication& authentication) {
  using Result = Checked<CommandReport>;
  command_t message;
  if (!is_sound_command(data, size_bytes)) return Result::reject("command_corrupt");
  if (!authentication.is_right(data, size_bytes)) return Result::reject("command_mac_wrong");
  if (!decode_whole(message, data, size_bytes)) return Result::reject("command_corrupt");
  const Twist twist{message.linear_mps, message.angular_radps};
  if (!is_finite(twist)) return Result::reject("command_not_finite");
  if (!is_plausible(twist) || !is_known(message.status, message.reason)) return Result::reject("command_out_of_bounds");
  return Result::accept({message.utime, message.session, message.counter, message.base_session, message.valid_until_us,
                         twist, message.simulated != 0, static_cast<Status>(message.status),
                         static_cast<Reason>(message.reason)});
}

/// With the unit quaternion (w, x, y, z) from body to local, the body's x axis in the local frame is
///
///   (1 - 2 (y^2 + z^2),  2 (x y + w z),  2 (x z - w y)),
///
/// and the forward speed is the velocity's part along it: (R^T vel).x. The turn rate is the one about the local z.
Checked<MotionReport> decode_pose(const void* data, std::size_t size_bytes) {
  using Result = Checked<MotionReport>;
  bot_core::pose_t message;
  if (!decode_whole(message, data, size_bytes)) return Result::reject("pose_corrupt");
  if (!is_usable_time(message.utime)) return Result::reject("pose_time_invalid");
  const Eigen::Vector4d q(message.orientation);
  const Eigen::Vector3d velocity(message.vel), rate(message.rotation_rate);
  if (!q.allFinite() || !velocity.allFinite() || !rate.allFinite()) return Result::reject("pose_not_finite");
  if (!(std::abs(q.norm() - 1.0) <= kUnitWithin)) return Result::reject("pose_not_a_rotation");
  if (velocity.cwiseAbs().maxCoeff() > kMaxPlausibleTwist.linear_mps ||
      std::abs(rate.z()) > kMaxPlausibleTwist.angular_radps)
    return Result::reject("pose_out_of_bounds");
  const double w = q(0), x = q(1), y = q(2), z = q(3);
  const Eigen::Vector3d forward(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y));
  return Result::accept({message.utime, {forward.dot(velocity), rate.z()}});
}

Checked<MotionReport> decode_motion(const void* data, std::size_t size_bytes) {
  using Result = Checked<MotionReport>;
  motion_t message;
  if (!decode_whole(message, data, size_bytes)) return Result::reject("motion_corrupt");
  if (!is_usable_time(message.utime)) return Result::reject("motion_time_invalid");
  const Twist twist{message.linear_mps, message.angular_radps};
  if (!is_finite(twist)) return Result::reject("motion_not_finite");
  if (!is_plausible(twist)) return Result::reject("motion_out_of_bounds");
  return Result::accept({message.utime, twist});
}

}  // namespace pilotfish::bus
