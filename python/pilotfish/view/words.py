"""A status in plain words, with numbers: what a page says in its largest letters. Pure functions of plain values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pilotfish.view.setup import Setup

HEADLINES = {
    "searching": ("Searching for the leader", "wait"),
    "tracking": ("Following the leader", "good"),
    "coasting": ("Coasting: not seen", "wait"),
    "lost": ("Lost: standing still", "bad"),
    "stopped": ("Stopped", "stop"),
    "invalid_input": ("Pictures unusable", "bad"),
}

# What a counter counts, for "in the last second: 28 x ...". Names: docs/operating-guide.md, Counters.
COUNTER_WORDS = {
    "frames_stale": "pictures too old when they arrived",
    "frames_not_advancing": "pictures not later than the one before",
    "frames_implausible": "pictures with a time that does not fit",
    "frames_repeated": "pictures equal to one before",
    "frames_frozen": "pictures of a frozen camera",
    "frames_overtaken": "pictures replaced by a newer one before they were processed",
    "frames_invalid": "pictures that cannot be read or are not of the calibration's size",
    "tag_hamming": "tags that read as something else",
    "tag_margin": "tags with too little contrast",
    "tag_residual": "tags partly covered or unlike their template",
    "tag_foreign_id": "tags the leader does not wear",
    "tag_duplicate_id": "tags seen twice in one picture",
    "tag_outside_frame": "tags partly outside the picture",
    "tag_too_small": "tags too small to be read",
    "tag_too_blurred": "tags too blurred",
    "tag_size": "tags of a size they cannot have",
    "pose": "poses that are not credible",
    "pose_behind": "poses behind the camera",
    "pose_jump": "poses too far from the one before",
    "setpoint_wrong_session": "setpoints for another run",
    "setpoint_replayed": "setpoints with an old counter",
    "setpoint_too_near": "setpoints below the stop distance",
    "setpoint_out_of_bounds": "setpoints out of bounds",
    "setpoint_mac_wrong": "setpoints without the right key",
    "rival_commands": "commands of another coordinator",
    "image_size_unexpected": "images that are not of the calibration's size",
    "ego_motion_unusable": "odometry that does not fit the pictures' time or is too old",
    "leader_intent_unusable": "leader intents that do not fit the pictures' time or are too old",
    "frames_without_ranges": "pictures that could not be followed for want of fresh ranges",
    "ranges_unusable": "ranges that do not fit the pictures' time or are too old",
    "messages_forgotten": "messages that did not fit into the queue",
    "log_lines_lost": "lines of the log that were not read in time",
    "black_box_dropped": "records that the disk was too slow for",
    "black_box_lost": "records that the disk refused",
    "command_mac_wrong": "commands without the right key",
    "message_incomplete": "messages of which a part never arrived",
    "receive_buffer_full": "times messages came faster than they were handled: the newest are lost",
}
# Of ROBOT1_BASE: docs/operating-guide.md, The wheels.
BASE_COUNTER_WORDS = {
    "base_session_wrong": "commands for another run of the wheels' process: harmless while one of the two is starting",
    "command_foreign": "commands of a second coordinator of this name",
    "command_expired": "commands that came after their measurement had become too old",
    "command_replayed": "commands that came twice, or of a recording",
    "command_session_ended": "commands of a coordinator that another has replaced",
    "command_after_gap": "commands from before a pause of the wheels' process: it was not running for a while",
    "command_simulated": "commands of a simulator or a recording, for real wheels",
    "command_mac_wrong": "commands without the right key",
    "setpoint_mac_wrong": "setpoints without the right key",
    "base_mac_wrong": "states of the wheels without the right key",
    "resume_other_session": "resumes for another run",
    "resume_replayed": "resumes with an old counter",
    "serial_flushed": "lines discarded before they were sent to the controller",
    "serial_blocked": "lines that the serial port did not take",
    "serial_lost": "times the serial port was lost",
    "line_checksum_wrong": "lines of the controller with a wrong checksum",
    "line_malformed": "lines of the controller that cannot be read",
    "line_too_long": "lines of the controller that are too long",
    "line_cut_short": "lines of the controller that were cut short",
    "odometry_jump": "encoder readings that no wheel can have made",
    "controller_watchdog": "times the controller stopped the wheels by itself",
    "command_malformed": "commands that cannot be read",
    "command_stale": "commands that were too old when they arrived",
    "command_sessions_full": "commands of more senders than are kept apart",
    "another_base": "states of a second wheels' process of this name",
}
_SAID_COUNTERS = 3


def describe(
    status: Mapping[str, Any],
    observation: Mapping[str, Any] | None,
    setup: Setup,
    *,
    picture_size: tuple[int, int] | None,
    last_seen_s: float | None,
    risen: Mapping[str, int],
) -> dict[str, Any]:
    """headline, tone (good, wait, bad, stop), why, and lines with numbers.

    last_seen_s: since the leader was last measured; risen: counters that rose in the last second, and by how much.
    """
    name = status["status"]
    headline, tone = HEADLINES.get(name, (f"Status {name}", "bad"))
    detected = observation is not None and observation["detected"]
    lines = []
    if detected and observation is not None and name in ("tracking", "stopped"):
        lines += _measured(status, observation, setup)
    elif last_seen_s is not None:
        # Of a robot that was stopped the limit is no reason.
        lines.append(f"last measured {_duration(last_seen_s)} ago{'' if name == 'stopped' else _limit(setup)}")
    elif name != "stopped":
        lines.append("not seen since this page has been watching")
    if not status["text"].endswith(")"):  # else it has its numbers
        lines += _of_reason(status["reason"], setup, picture_size)
    if not detected:
        lines += _of_counters(risen)
    if name == "stopped":
        lines.append(f"would keep {_kept(status)}")
    return {"headline": headline, "tone": tone, "why": status["text"], "lines": lines}


def describe_base(base: Mapping[str, Any]) -> str:
    """The wheels' process in one line."""
    said = f": {base['text']}" if base["text"] else ""
    return f"wheels {base['state']}{said}"


def _measured(status: Mapping[str, Any], observation: Mapping[str, Any], setup: Setup) -> list[str]:
    place = f"{observation['distance_m']:.2f} m away, {side(observation['bearing_rad'])}"
    if status["status"] == "tracking":
        place += f"; to keep: {_kept(status)}"
    tags = observation["tags"]
    seen = f"{len(tags)} {'tag' if len(tags) == 1 else 'tags'} ({ids_text([tag['id'] for tag in tags])})"
    if setup.tag_ids:
        seen += f" of the body's {len(setup.tag_ids)} ({ids_text(setup.tag_ids)})"
    lines = [place, seen if tags else "measured, without a list of tags"]
    error_px = observation["reprojection_error_px"]
    if error_px is not None:
        limit = f", limit {setup.max_reprojection_error_px:g}" if setup.max_reprojection_error_px else ""
        lines.append(f"reprojection error {error_px:.2f} px{limit}")
    return lines


def _of_reason(reason: str, setup: Setup, picture_size: tuple[int, int] | None) -> list[str]:
    if reason == "frame_size_not_calibrated":
        frame = _size(picture_size) if picture_size else "not on the bus"
        calibration = _size(setup.camera_size) if setup.camera_size else "known with --config"
        return [f"frame {frame}, calibration {calibration}"]
    if reason == "no_tag_of_the_leader" and setup.tag_ids:
        return [f"the body has {ids_text(setup.tag_ids)}"]
    if reason == "pose_refused" and setup.max_reprojection_error_px:
        return [f"reprojection errors above {setup.max_reprojection_error_px:g} px are refused"]
    if reason == "tag_refused" and setup.min_decision_margin:
        return [f"decision margins below {setup.min_decision_margin:g} gray levels are refused"]
    if reason == "frame_stale" and setup.max_age_s:
        return [f"pictures older than {setup.max_age_s * 1e3:.0f} ms are refused"]
    return []


def _of_counters(risen: Mapping[str, int]) -> list[str]:
    most = sorted(((count, name) for name, count in risen.items() if name in COUNTER_WORDS and count > 0), reverse=True)
    return [f"in the last second: {count} x {COUNTER_WORDS[name]}" for count, name in most[:_SAID_COUNTERS]]


def _limit(setup: Setup) -> str:
    return f"; after {setup.max_age_s * 1e3:.0f} ms the robot stands still" if setup.max_age_s else ""


def _kept(status: Mapping[str, Any]) -> str:
    distance_m, bearing_rad = status["setpoint_distance_m"], status["setpoint_bearing_rad"]
    if distance_m is None or bearing_rad is None:
        return "numbers that are not finite"
    return f"{distance_m:.2f} m, {side(bearing_rad)}"


def side(bearing_rad: float) -> str:
    """ "10.0° to the right": a bearing without a sign to remember."""
    degrees = math.degrees(bearing_rad)
    if abs(degrees) < 0.05:
        return "straight ahead"
    return f"{abs(degrees):.1f}° to the {'left' if degrees > 0 else 'right'}"


def ids_text(ids: Sequence[int]) -> str:
    """ "ids 0 to 2", "ids 0, 3, 7", "id 4" """
    ordered = sorted(set(ids))
    if len(ordered) == 1:
        return f"id {ordered[0]}"
    if len(ordered) > 2 and ordered[-1] - ordered[0] == len(ordered) - 1:
        return f"ids {ordered[0]} to {ordered[-1]}"
    return f"ids {', '.join(map(str, ordered))}"


def _duration(seconds: float) -> str:
    return f"{seconds * 1e3:.0f} ms" if seconds < 1 else f"{seconds:.1f} s"


def _size(size: tuple[int, int]) -> str:
    return f"{size[0]} x {size[1]}"
