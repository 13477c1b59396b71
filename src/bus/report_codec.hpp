#pragma once

#include <bot_core/pose_t.hpp>
#include <cstddef>
#include <optional>
#include <pilotfish/command_t.hpp>
#include <pilotfish/motion_t.hpp>
#include <pilotfish/observation_t.hpp>
#include <pilotfish/setpoint_t.hpp>

#include "authentication.hpp"
#include "checked.hpp"
#include "pilotfish/bus/reports.hpp"

namespace pilotfish::bus {

// Reports to messages. All numbers sent are finite: each of these names in `repaired` (empty if there was no
// need) what it replaced, so that a bug upstream is counted and never reaches a motor.

/// Zeros with Reason::law_not_finite instead of a velocity that is not finite.
command_t encode(const CommandReport& report, std::string_view& repaired);
/// "Not detected" instead of an observation with a number that is not finite; the first 12 tags.
observation_t encode(const ObservationReport& report, std::string_view& repaired);
/// Zeros for numbers that are not finite.
bot_core::pose_t encode(const PoseReport& report, std::string_view& repaired);
/// Nothing for numbers that are not finite: a zero would mean that the robot stands.
std::optional<motion_t> encode(const MotionReport& report);
setpoint_t encode(const SetpointReport& report);

/// Rejections: setpoint_corrupt, setpoint_mac_wrong, setpoint_not_finite, setpoint_out_of_bounds. A stop that has one
/// of the last three is passed on nevertheless, as a bare stop (session and counter 0), beside the rejection.
Checked<SetpointReport> decode_setpoint(const void* data, std::size_t size_bytes, const Authentication& authentication);
/// Rejections: command_corrupt, command_mac_wrong, command_not_finite, command_out_of_bounds (velocities no robot of
/// ours has, or a status or reason that we do not know).
Checked<CommandReport> decode_command(const void* data, std::size_t size_bytes, const Authentication& authentication);

/// Rejections: pose_corrupt, pose_time_invalid, pose_not_finite, pose_not_a_rotation (the orientation is no unit
/// quaternion), pose_out_of_bounds. Only the fields of the twist are used.
Checked<MotionReport> decode_pose(const void* data, std::size_t size_bytes);
/// Rejections: motion_corrupt, motion_time_invalid, motion_not_finite, motion_out_of_bounds.
Checked<MotionReport> decode_motion(const void* data, std::size_t size_bytes);

inline constexpr std::size_t kMaxTags = 12;

}  // namespace pilotfish::bus
