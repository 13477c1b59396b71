"""The figures on top of the page of a single run, and what each is worth: a figure "after the approach" of a run that
has not settled, that has lost its leader or whose recording is cut is no verdict on the law."""

from __future__ import annotations

from html import escape

import numpy as np

from pilotfish.logs.beginning import approach_is_missing, late_beginnings
from pilotfish.logs.run import RobotRun, Run
from pilotfish.logs.summary import TITLES, Summary, shown
from pilotfish.logs.unseen import never_measured

_TILES = (
    "duration_s",
    "followed_share",
    "rms_distance_error_mm",
    "rms_bearing_error_deg",
    "settling_s",
    "latency_p99_ms",
    "zeros_without_picture",
)
_OF_THE_END = ("rms_distance_error_mm", "rms_bearing_error_deg", "settling_s")  # what they say, the run's end decides
_UNSEEN, _LATE = "never measured", "the approach is not recorded"
_LEFT_S = 1.0  # that a run goes on behind its last followed frame: shorter is a frame that was not seen


def tiles(recording: Run, robot: RobotRun, summary: Summary) -> str:
    """As HTML; those that are in doubt are marked and say why."""
    doubts = doubts_of(recording, robot, summary)
    parts = []
    for name in _TILES:
        label, unit, _ = TITLES[name]
        value = f"{shown(name, getattr(summary, name))} {unit}".strip()
        if name == "settling_s" and not np.isfinite(summary.settling_s):
            value = "–" if _UNSEEN in doubts or _LATE in doubts else "not settled"  # noqa: RUF001
        said = [doubt for doubt in doubts if name == "settling_s" or doubt != _LATE] if name in _OF_THE_END else []
        why = f'<div class="why">{escape(", ".join(said))}</div>' if said else ""
        kind = "tile doubt" if said else "tile"
        parts.append(f'<div class="{kind}"><b>{escape(value)}</b>{escape(label)}{why}</div>')
    return f'<div class="tiles">{"".join(parts)}</div>'


def doubts_of(recording: Run, robot: RobotRun, summary: Summary) -> dict[str, str]:
    """Why the figures of the run's end are none of a settled run that was recorded to its end: in a few words, and in a
    sentence."""
    doubts = {}
    late = late_beginnings(robot) if approach_is_missing(robot) else []
    if unseen := never_measured(robot):
        doubts[_UNSEEN] = "; ".join([unseen, *late])
    elif late:
        doubts[_LATE] = "; ".join([*late, "the approach is not in it, and has no figures"])
    elif not np.isfinite(summary.settling_s):
        doubts["not settled"] = (
            "it has not settled: in its last quarter the distance error left its mean by more than 50 mm, or there was "
            "too little of it. What stands as after the approach is that quarter all the same"
        )
    if not unseen:
        doubts |= _left_off(robot)
    if any(damage.at_end for damage in recording.damage):
        doubts["the recording is cut"] = "the recording is cut: how the run went on is not known"
    return doubts


def _left_off(robot: RobotRun) -> dict[str, str]:
    """That it followed no more at the end, and since when. A stop is an end as well as any."""
    table = robot.commands if len(robot.commands) else robot.frames
    time_s, words = table["t_s"], table.words("status")
    status = str(words[-1])
    followed = np.flatnonzero(words == "tracking")
    end_s, last_s = float(time_s[-1]), float(time_s[followed[-1] if followed.size else 0])
    if status in ("tracking", "stopped") or end_s - last_s <= _LEFT_S:
        return {}
    at_end = f"{status.replace('_', ' ')} at the end"
    until = f"it followed until {last_s:.1f} s only" if followed.size else "it never followed"
    return {at_end: f"{until}, and was {at_end} ({end_s:.1f} s)"}
