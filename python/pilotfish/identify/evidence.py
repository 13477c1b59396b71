"""What a recorded run says of the drive: what was seen of the leader, and what was commanded, on one clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pilotfish.errors import RecordingError
from pilotfish.logs.run import RobotRun
from pilotfish.recording import Recording

FloatArray = NDArray[np.float64]
LEAST_FRAMES = 60
_PAUSE_US = 3600e6
_STATED_DISTANCE_SIGMA_M, _STATED_BEARING_SIGMA_RAD = 0.03e-3, 0.015e-3  # where a run states none


@dataclass(frozen=True)
class Evidence:
    """Times [s] of exposures, rising; (N,) distance, bearing (of the frames in which the leader was measured) and the
    standard deviations that the coordinator states; (M,) commands and the exposure that each answers: it reaches the
    wheels one latency later."""

    time_s: FloatArray
    distance_m: FloatArray
    bearing_rad: FloatArray
    distance_sigma_m: FloatArray
    bearing_sigma_rad: FloatArray
    command_time_s: FloatArray
    linear_mps: FloatArray
    angular_radps: FloatArray


def evidence_of(robot: RobotRun) -> Evidence:
    """Of one robot of a log. RecordingError if it has too few frames, or no commands.

    Stamps say when frames were exposed. A command names the frame that it answers; what was sent later for the same
    frame (zeros, when no picture came) counts from it by the recording's clock, unless time was a simulator's, which
    stands still then."""
    frames, commands = robot.frames, robot.commands
    good = frames["measured"] & np.isfinite(frames["distance_m"]) & np.isfinite(frames["bearing_rad"])
    plausible = _together(frames["utime_us"])
    good &= plausible
    epoch = int(frames["utime_us"][plausible][0]) if plausible.any() else 0
    time_s = (frames["utime_us"] - epoch) * 1e-6
    answered, speed, turn = _answers(robot, epoch)
    if not len(answered):
        raise RecordingError(
            f"no command of '{robot.name}' is recorded ({len(frames)} frames, {len(commands)} commands): record "
            f"{robot.name.upper()}_COMMAND too, or use the black box (pilotfish-coordinator --record DIR)"
        )
    return _checked(
        robot.name,
        time_s[good],
        frames["distance_m"][good],
        frames["bearing_rad"][good],
        frames["distance_sigma_m"][good],
        frames["bearing_sigma_rad"][good],
        answered,
        speed,
        turn,
    )


def evidence_from_recording(run: Recording) -> Evidence:
    """Of a simulated run: only what a coordinator knew, nothing of the truth."""
    good = np.isfinite(run.measured_distance_m) & run.delivered
    time_s = (run.utime_us - run.utime_us[0]) * 1e-6
    distance_m, answered = run.measured_distance_m[good], run.delivered & (run.status != "")
    return _checked(
        run.meta.robot,
        time_s[good],
        distance_m,
        run.measured_bearing_rad[good],
        _STATED_DISTANCE_SIGMA_M * distance_m**2,
        np.full(len(distance_m), _STATED_BEARING_SIGMA_RAD),
        time_s[answered],
        run.command_linear_mps[answered],
        run.command_angular_radps[answered],
    )


def _answers(robot: RobotRun, epoch: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Exposures answered [s] and commands (speed, turn rate), rising in time."""
    commands, frames = robot.commands, robot.frames
    if len(commands):
        utime, sent_s = commands["utime_us"], commands["t_s"]
        _, first, which = np.unique(utime, return_index=True, return_inverse=True)
        later_s = sent_s - sent_s[first][which]
        keep = (utime > 0) & (later_s >= 0)
        if robot.simulated:
            keep &= np.isin(np.arange(len(utime)), first)
        at_s = ((utime - epoch) * 1e-6 + later_s)[keep]
        speed, turn = commands["linear_mps"][keep], commands["angular_radps"][keep]
    else:
        keep = np.isfinite(frames["command_linear_mps"])
        at_s = ((frames["utime_us"] - epoch) * 1e-6)[keep]
        speed, turn = frames["command_linear_mps"][keep], frames["command_angular_radps"][keep]
    near = _together(np.rint(at_s * 1e6))
    at_s, speed, turn = at_s[near], speed[near], turn[near]
    order = np.argsort(at_s, kind="stable")
    rising = np.append(np.diff(at_s[order]) > 0, True)[: len(order)]
    kept = order[rising]
    finite = np.isfinite(speed[kept]) & np.isfinite(turn[kept])
    return at_s[kept][finite], speed[kept][finite], turn[kept][finite]


def _together(utime_us: NDArray[Any]) -> NDArray[np.bool_]:
    """Which stamps belong to the run: the most that have no more than _PAUSE_US between two of them. A bit that has
    changed on a disk puts one years away."""
    if not len(utime_us):
        return np.zeros(0, bool)
    order = np.argsort(utime_us, kind="stable")
    part = np.append(0, np.cumsum(np.diff(utime_us[order].astype(float)) > _PAUSE_US))
    together = np.zeros(len(utime_us), bool)
    together[order[part == np.bincount(part).argmax()]] = True
    return together


def _checked(name: str, *columns: FloatArray) -> Evidence:
    time_s = columns[0]
    rises = np.append(True, time_s[1:] > np.maximum.accumulate(time_s)[:-1])[: len(time_s)]
    seen = [np.asarray(column, dtype=float)[rises] for column in columns[:5]]
    if len(seen[0]) < LEAST_FRAMES:
        raise RecordingError(
            f"the leader was measured in {len(seen[0])} frames of '{name}', and {LEAST_FRAMES} are needed: record a "
            "longer run in which it follows"
        )
    floors = (_STATED_DISTANCE_SIGMA_M * seen[1] ** 2, np.full(len(seen[0]), _STATED_BEARING_SIGMA_RAD))
    for at, floor in zip((3, 4), floors, strict=True):
        seen[at] = np.where(np.isfinite(seen[at]) & (seen[at] > 1e-9), seen[at], floor)
    return Evidence(*seen, *columns[5:])
