#pragma once

// The one description of what a coordinator reports of a frame and of itself. The JSON lines, pilotfish.status_t's
// reader and writer, bus::StatusReport, both Python interfaces and the API reference are made from these rows; beside a
// row of PILOTFISH_STATUS_FIELDS there is only the field in lcmtypes/pilotfish_status_t.lcm, and a test compares them.
//
// A row's value is an expression that is compiled only where the names in it are declared
// (coordinator/telemetry.hpp lists them), so that the bus, which does not depend on the coordinator, can use
// the rest.

// clang-format off
/// The fields of a JSON line that observation_t and command_t carry in their own form: X(name, unit, source, value,
/// text). source: a pointer; while it is null there is no value.
#define PILOTFISH_FRAME_FIELDS(X)                                                                                     \
  X(utime, "us", step, step->utime, "exposure of the frame")                                                          \
  X(status, "", step, step->status, "what the coordinator is doing")                                                  \
  X(reason, "", step, step->reason, "why, in words; empty: nothing to explain")                                       \
  X(detected, "", step, step->observation.has_value(), "the leader was measured in this very frame")                  \
  X(distance_m, "m", seen, seen->distance_m, "d, between the two base origins")                                       \
  X(bearing_rad, "rad", seen, seen->bearing_rad, "theta of the leader's base origin, positive: to the left")          \
  X(heading_rad, "rad", seen, seen->heading_rad, "psi, the leader's heading relative to the coordinator's, filtered") \
  X(reprojection_error_px, "px", seen, seen->reprojection_error_px, "RMS over all corners used")                      \
  X(ambiguity_ratio, "", seen, seen->ambiguity_ratio,                                                                 \
    "error of the worse planar solution over the better one's; near 1 the heading is unsure")                         \
  X(heading_ambiguity, "", seen, seen->heading_ambiguity,                                                             \
    "probability that the heading is of the wrong one of the two solutions")                                          \
  X(found_by, "", seen, seen->found_by, "track, region, frame: where the tags were found")                            \
  X(tag_ids, "", step, tag_ids(seen), "of the tags used")                                                             \
  X(decision_margins, "gray levels", step, decision_margins(seen), "one a tag")                                       \
  X(corners_px, "px", step, corners_px(seen),                                                                         \
    "(tags, 4, 2): bottom left, bottom right, top right, top left of each, as one reads it")                          \
  X(linear_mps, "m/s", step, step->command.linear_mps, "forward speed of the command")                                \
  X(angular_radps, "rad/s", step, step->command.angular_radps, "turn rate of the command, positive: to the left")

/// The numbers of pilotfish.status_t, in its order, between its text and its lists (the setpoint, which is a value of
/// its own, stands among them there). FRAME(type, name, unit, source, value, text): of a frame, a JSON line has it,
/// too. LOOP(type, name, unit, value, text): of the program. type: on the wire; std::int8_t is an enumeration, text in
/// JSON.
#define PILOTFISH_STATUS_FIELDS(FRAME, LOOP)                                                                          \
  FRAME(double, error_m, "m", law, law->error_m, "e = d_p - d, wanted minus measured distance, positive: too close")  \
  FRAME(double, error_change_m, "m", law, law->error_change_m, "ec: change of e over one control period")             \
  FRAME(double, output, "", law, law->inference.output, "u of the fuzzy law, in its universe -1 to 1")                \
  LOOP(std::int64_t, session, "", config.session, "the coordinator's, as in a command; setpoints name it")            \
  LOOP(std::int64_t, setpoint_counter, "", setpoint_counter,                                                          \
    "of the last setpoint accepted in this session; the next must be higher")                                         \
  FRAME(double, feed_forward_weight, "", output, output->feed_forward_weight,                                         \
    "share of the feed-forward in the command, 0 to 1; 0: the law as published")                                      \
  FRAME(double, leader_radial_mps, "m/s", leader, leader->radial_mps,                                                 \
    "the leader's own speed along the line of sight, positive: away, as predicted for when the command has taken "    \
    "effect; of no meaning while feed_forward_weight is 0")                                                           \
  FRAME(double, leader_tangential_mps, "m/s", leader, leader->tangential_mps,                                         \
    "and across it, positive: to the left; of no meaning while feed_forward_weight is 0")                             \
  FRAME(double, leader_turn_rate_radps, "rad/s", leader, leader->turn_rate_radps,                                     \
    "the leader's turn rate, positive: to the left; of no meaning while feed_forward_weight is 0")                    \
  FRAME(std::int8_t, ego_motion, "", output, output->ego_motion,                                                      \
    "where the own motion is taken from; on the wire status_t's EGO_MOTION_ numbers")                                 \
  FRAME(std::int8_t, leader_intent, "", output, output->leader_intent,                                                \
    "how the leader intent is used; on the wire status_t's LEADER_INTENT_ numbers")                                 \
  LOOP(double, frame_rate_hz, "Hz", timing.frame_rate_hz, "rate at which frames come")                                \
  LOOP(double, processing_ms, "ms", timing.processing_s * 1e3, "time spent on this frame")                            \
  FRAME(double, latency_s, "s", timing, timing->median_latency_s,                                                     \
    "to the command, median of the last frames, without what the wheel driver takes")                                 \
  FRAME(bool, latency_from_exposure, "", step, timing != nullptr && timing->from_exposure,                            \
    "latency_s counts from the exposure; else from the image's arrival")                                              \
  FRAME(double, drive_latency_s, "s", drive, drive->latency_s,                                                        \
    "from the exposure to the moment the command for it reaches the wheels, as it is used: configured, or identified") \
  FRAME(double, drive_latency_sigma_s, "s", drive, drive->latency_sigma_s,                                            \
    "standard deviation of its identification; 0.1: not observable in the motion so far")                              \
  FRAME(double, drive_lag_s, "s", drive, drive->actuator_lag_s,                                                       \
    "time constant of the wheels' speed control, as it is used: configured, or identified")                           \
  FRAME(double, drive_lag_sigma_s, "s", drive, drive->actuator_lag_sigma_s,                                           \
    "standard deviation of its identification")                                                                       \
  LOOP(double, configured_latency_s, "s", config.configured_latency_s, "what control.drive.latency_s says")           \
  LOOP(std::int64_t, missed_deadlines, "", sender.missed_deadlines, "commands that left later than they were due")    \
  LOOP(std::int64_t, clock_epochs, "", coordinator.clock_epochs(), "how often the clock of the images was set")        \
  FRAME(std::int64_t, leader_index, "", step, step->leader_index,                                                     \
    "who is followed: 0 the configured leader, 1 the first of alternatives.leaders, ...")                             \
  FRAME(std::int64_t, leader_changes, "", step, step->leader_changes,                                                 \
    "how often that has changed since the start")
// clang-format on
