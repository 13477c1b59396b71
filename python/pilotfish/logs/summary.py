"""What a recorded run amounts to, from what the coordinator itself measured: no truth is recorded on a robot.

"After the approach" is what pilotfish.metrics calls the steady window W: the last quarter of the part that begins with
the last setpoint, start or resume, of which only frames count that were followed. The approach is what comes before
the distance has settled: from wherever the robot was put, so its error says nothing about the law.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pilotfish.logs.beginning import approach_is_missing
from pilotfish.logs.run import RobotRun, Table
from pilotfish.metrics import settling_time_s, steady_window
from pilotfish.recording import wrap_angle
from pilotfish.zero_commands import FOLLOWING, NO_PICTURE

_REGULAR = 1.5  # times the median period: frames further apart are not neighbours


@dataclass(frozen=True)
class Summary:
    """Figures of one robot's run; NaN where there is nothing to compute them from. Errors as vision measured them."""

    duration_s: float  # from the first frame to the last
    frames: int
    frame_rate_hz: float  # of the frames in it
    measured_share: float  # of the frames: the leader was measured
    followed_share: float  # of the frames: status tracking
    rms_distance_error_mm: float  # after the approach
    p95_distance_error_mm: float  # of the magnitude, after the approach
    rms_bearing_error_deg: float  # after the approach
    p95_bearing_error_deg: float  # of the magnitude, after the approach
    steady_distance_error_mm: float  # mean, after the approach
    approach_from_mm: float  # the distance error with which the approach began
    settling_s: float  # of the approach: until within 50 mm of the steady-state error, for good; NaN: not settled
    rms_whole_distance_error_mm: float  # while following, the approach included
    rms_jerk_mps3: float  # of the commanded speed, from start to end
    latency_p50_ms: float  # from a frame's arrival to its report
    latency_p99_ms: float
    latency_max_ms: float
    processing_p50_ms: float
    processing_p99_ms: float
    missed_deadlines: int
    zeros_without_picture: float  # times that zero was commanded for want of a picture; NaN: no commands recorded


TITLES = {
    "duration_s": ("duration", "s", 2),
    "frames": ("frames", "", 0),
    "frame_rate_hz": ("frame rate", "Hz", 2),
    "measured_share": ("share of frames with the leader measured", "%", 2),
    "followed_share": ("share of frames followed (tracking)", "%", 2),
    "rms_distance_error_mm": ("RMS distance error after the approach", "mm", 2),
    "p95_distance_error_mm": ("95th percentile of |distance error| after the approach", "mm", 2),
    "rms_bearing_error_deg": ("RMS bearing error after the approach", "°", 3),
    "p95_bearing_error_deg": ("95th percentile of |bearing error| after the approach", "°", 3),
    "steady_distance_error_mm": ("steady-state distance error (its mean after the approach)", "mm", 2),
    "approach_from_mm": ("approach: distance error at its start (negative: too far)", "mm", 0),
    "settling_s": ("approach: settling to the steady-state error ± 50 mm", "s", 2),
    "rms_whole_distance_error_mm": ("RMS distance error while following, approach included", "mm", 2),
    "rms_jerk_mps3": ("RMS jerk of the commanded speed, from start to end", "m/s³", 2),
    "latency_p50_ms": ("latency, arrival to report: median", "ms", 2),
    "latency_p99_ms": ("latency: 99th percentile", "ms", 2),
    "latency_max_ms": ("latency: longest", "ms", 2),
    "processing_p50_ms": ("processing: median", "ms", 2),
    "processing_p99_ms": ("processing: 99th percentile", "ms", 2),
    "missed_deadlines": ("missed deadlines", "", 0),
    "zeros_without_picture": ("commanded zero for want of a picture, while following", "times", 0),
}


def summarize(run: RobotRun) -> Summary:
    """All figures of a robot with at least one frame."""
    frames = run.frames
    time_s = frames["t_s"]
    following = frames.words("status") == "tracking"
    bearing_rad = wrap_angle(frames["bearing_rad"] - frames["setpoint_bearing_rad"])
    last, steady = _last_stretch(run)
    distance_mm, bearing_rad = 1e3 * frames["error_m"][steady], bearing_rad[steady]
    approach = last[:0] if approach_is_missing(run) else last
    settled_s = settling_time_s(time_s[approach], frames["error_m"][approach]) if approach.size else None
    latency_ms, duration_s = 1e3 * frames["latency_s"], float(time_s[-1] - time_s[0])
    return Summary(
        duration_s=duration_s,
        frames=len(frames),
        frame_rate_hz=(len(frames) - 1) / duration_s if duration_s > 0 else np.nan,
        measured_share=float(frames["measured"].mean()),
        followed_share=float(following.mean()),
        rms_distance_error_mm=_rms(distance_mm),
        p95_distance_error_mm=_percentile(np.abs(distance_mm), 95),
        rms_bearing_error_deg=float(np.degrees(_rms(bearing_rad))),
        p95_bearing_error_deg=float(np.degrees(_percentile(np.abs(bearing_rad), 95))),
        steady_distance_error_mm=float(distance_mm.mean()) if distance_mm.size else np.nan,
        approach_from_mm=1e3 * float(frames["error_m"][approach[0]]) if approach.size else np.nan,
        settling_s=np.nan if settled_s is None else settled_s,
        rms_whole_distance_error_mm=_rms(1e3 * frames["error_m"][following]),
        rms_jerk_mps3=rms_jerk_mps3(time_s, frames["command_linear_mps"]),
        latency_p50_ms=_percentile(latency_ms, 50),
        latency_p99_ms=_percentile(latency_ms, 99),
        latency_max_ms=_percentile(latency_ms, 100),
        processing_p50_ms=_percentile(frames["processing_ms"], 50),
        processing_p99_ms=_percentile(frames["processing_ms"], 99),
        missed_deadlines=_sum_over_sessions(frames["missed_deadlines"], frames["session"]),
        zeros_without_picture=zeros_without_picture(run.commands),
    )


def zeros_without_picture(commands: Table) -> float:
    """How often a robot that followed was told to stand still because no picture came in time: stretches of such
    commands, each counted once. Frames know nothing of them: they are sent where there is none."""
    if not len(commands):
        return np.nan
    waits = np.isin(commands.words("reason"), NO_PICTURE) & ~np.isin(commands.words("status"), FOLLOWING)
    followed = np.isin(commands.words("status"), FOLLOWING)
    same_start = commands["session"][1:] == commands["session"][:-1]
    return float(np.count_nonzero(waits[1:] & followed[:-1] & same_start))


def shown(name: str, value: float) -> str:
    """A figure as people read it, without its unit (TITLES has it)."""
    _, unit, digits = TITLES[name]
    if not np.isfinite(value):
        return "–"  # noqa: RUF001
    rounded = round(100 * value if unit == "%" else value, digits) + 0.0  # no "-0.00"
    return f"{rounded:.{digits}f}"


def rms_jerk_mps3(time_s: NDArray[np.float64], speed_mps: NDArray[np.float64]) -> float:
    """RMS of the second difference of the commanded speed over the period squared, as metrics.rms_jerk_mps3 says it; of
    three frames that are neighbours only, so that gaps count nothing."""
    gaps_s = np.diff(time_s)
    if len(gaps_s) < 2:
        return np.nan
    period_s = float(np.median(gaps_s))
    near = (gaps_s < _REGULAR * period_s) & (gaps_s > 0)
    return _rms(np.diff(speed_mps, 2)[near[1:] & near[:-1]] / period_s**2) if period_s > 0 else np.nan


def _last_stretch(run: RobotRun) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Numbers of the frames that were followed since the last setpoint, start or resume, and of those of them that are
    in the steady window; empty if there are none."""
    since_s = max((event.t_s for event in run.events if event.kind in ("setpoint", "resume", "start")), default=0.0)
    frames = run.frames
    followed = np.isfinite(frames["error_m"]) & (frames.words("status") == "tracking")
    last = np.flatnonzero((frames["t_s"] >= since_s) & followed)
    return last, last[steady_window(frames["t_s"][last])] if last.size else last


def _sum_over_sessions(counts: NDArray[np.int64], sessions: NDArray[np.int64]) -> int:
    """Of a counter that begins again with every start of the program."""
    return int(sum(max(0, counts[sessions == session].max()) for session in np.unique(sessions)))


def _rms(values: NDArray[np.float64]) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(np.square(known)))) if known.size else np.nan


def _percentile(values: NDArray[np.float64], percent: float) -> float:
    known = values[np.isfinite(values)]
    return float(np.percentile(known, percent)) if known.size else np.nan
