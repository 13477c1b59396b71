"""Whether a formation holds: the errors of each robot relative to its leader, how long it takes to form again, and how
near any two robots come to each other.

Signs as in pilotfish.metrics: e = d_p - d (positive: too close), b = theta - theta_pd, both of the true pose.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pilotfish.formation.run import FormationRun
from pilotfish.metrics import STEADY_FRACTION
from pilotfish.recording import FloatArray, wrap_angle


@dataclass(frozen=True)
class Keeping:
    """How well one robot keeps its place relative to its leader, over the last quarter of the run's last shape."""

    robot: str
    leader: str
    distance_setpoint_m: float
    bearing_setpoint_rad: float
    mean_error_m: float
    max_error_m: float  # of |e|
    mean_bearing_error_rad: float
    max_bearing_error_rad: float  # of |b|
    place_error_m: float  # mean distance from its place in the frame of the leader in front; on a curve not zero
    seen_ratio: float  # share of all pictures in which the leader was measured


@dataclass(frozen=True)
class Forming:
    """From a change of shape (or the start) to the formation: None if it was not formed before the next one."""

    at_s: float
    shape: str
    formed_after_s: float | None
    least_apart_m: float  # between the turning centres of any two robots, from the change to the next one
    nearest: tuple[str, str]  # those two


def errors(run: FormationRun, robot: str) -> tuple[FloatArray, FloatArray]:
    """(e [m], b [rad]) of a robot, shape (N,) each, relative to the setpoint that was in force."""
    recording = run.recordings[robot]
    return (
        run.distance_setpoint_m[robot] - recording.true_distance_m,
        wrap_angle(recording.true_bearing_rad - run.bearing_setpoint_rad[robot]),
    )


def keeping(run: FormationRun) -> list[Keeping]:
    """Of every robot that follows."""
    results = []
    off_place_m = place_errors_m(run)
    for robot, recording in run.recordings.items():
        error_m, bearing_rad = errors(run, robot)
        begun_s = max(stage.at_s for stage in run.formation.stages if stage.at_s <= recording.time_s[-1])
        end_s = float(recording.time_s[-1])
        late = recording.time_s >= end_s - STEADY_FRACTION * (end_s - begun_s) - 1e-9
        results.append(
            Keeping(
                robot=robot,
                leader=recording.meta.leader,
                distance_setpoint_m=float(run.distance_setpoint_m[robot][-1]),
                bearing_setpoint_rad=float(run.bearing_setpoint_rad[robot][-1]),
                mean_error_m=float(error_m[late].mean()),
                max_error_m=float(np.abs(error_m[late]).max()),
                mean_bearing_error_rad=float(bearing_rad[late].mean()),
                max_bearing_error_rad=float(np.abs(bearing_rad[late]).max()),
                place_error_m=float(off_place_m[robot][late].mean()),
                seen_ratio=float((recording.status == "tracking").mean()),
            )
        )
    return results


def formed(run: FormationRun) -> FloatArray:
    """(N,) bool: whether at that time every robot is where it shall be relative to its leader, within the formation's
    tolerance along the line of sight (|e|) and across it (d_p |b|)."""
    within = []
    for robot in run.recordings:
        error_m, bearing_rad = errors(run, robot)
        across_m = run.distance_setpoint_m[robot] * np.abs(bearing_rad)
        within.append(np.maximum(np.abs(error_m), across_m) <= run.formation.tolerance_m)
    return np.all(within, axis=0)


def forming(run: FormationRun) -> list[Forming]:
    """For the start and each change: the time from its ``at_s`` until the formation is formed for good, that is to the
    next change or the end. While setpoints still move (``over_s``) it does not count as formed."""
    time_s = next(iter(run.recordings.values())).time_s
    is_formed = formed(run)
    stages = [stage for stage in run.formation.stages if stage.at_s <= time_s[-1]]
    ends = [*(stage.at_s for stage in stages[1:]), np.inf]
    results = []
    for stage, end_s in zip(stages, ends, strict=True):
        within = (time_s >= stage.at_s - 1e-9) & (time_s < end_s - 1e-9)
        moved = [np.flatnonzero(np.diff(run.distance_setpoint_m[r][within]) != 0.0) for r in run.recordings]
        moved += [np.flatnonzero(np.diff(run.bearing_setpoint_rad[r][within]) != 0.0) for r in run.recordings]
        settled_at = max((int(each[-1]) + 1 for each in moved if each.size), default=0)
        outside = np.flatnonzero(~is_formed[within])
        first = max(settled_at, 0 if outside.size == 0 else int(outside[-1]) + 1)
        times = time_s[within]
        apart_m, nearest = least_apart_m(positions(run), within)
        after_s = float(times[first] - stage.at_s) if first < len(times) else None
        results.append(Forming(stage.at_s, stage.shape.name, after_s, apart_m, nearest))
    return results


def place_errors_m(run: FormationRun) -> dict[str, FloatArray]:
    """(N,) for each robot: how far it is from its place in the last shape, in the frame of the leader in front.
    A robot that keeps distance and bearing comes to its place once all robots look the same way, as they do behind a
    leader that drives straight ahead: a robot d behind turns to the leader's heading with the time constant d / v."""
    first = next(each for each in run.recordings.values() if each.meta.leader not in run.recordings)
    at_x, at_y, heading = first.leader_x_m, first.leader_y_m, first.leader_heading_rad
    last = [stage for stage in run.formation.stages if stage.at_s <= first.time_s[-1]][-1]
    off = {}
    for robot, recording in run.recordings.items():
        dx, dy = recording.x_m - at_x, recording.y_m - at_y
        along = np.cos(heading) * dx + np.sin(heading) * dy - last.places[robot][0]
        across = -np.sin(heading) * dx + np.cos(heading) * dy - last.places[robot][1]
        off[robot] = np.hypot(along, across)
    return off


def positions(run: FormationRun) -> dict[str, FloatArray]:
    """(N, 2) of every robot, also of the leader in front, in the world frame [m]."""
    where = {}
    for robot, recording in run.recordings.items():
        if recording.meta.leader not in run.recordings:
            where[recording.meta.leader] = np.stack([recording.leader_x_m, recording.leader_y_m], axis=-1)
        where[robot] = np.stack([recording.x_m, recording.y_m], axis=-1)
    return where


def least_apart_m(where: Mapping[str, FloatArray], rows: np.ndarray | slice) -> tuple[float, tuple[str, str]]:
    """The least distance of any two robots within the rows, and which two."""
    apart = {
        (a, b): float(np.linalg.norm(where[a][rows] - where[b][rows], axis=-1).min())
        for a, b in itertools.combinations(where, 2)
    }
    nearest = min(apart, key=lambda pair: apart[pair])
    return apart[nearest], nearest
