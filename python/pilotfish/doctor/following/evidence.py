"""Numbers of what was watched: shares, rates, latencies, counters that rose. Pure functions of Watched."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import median
from typing import Any

from pilotfish.core import Reason, Status
from pilotfish.doctor.following.load import Late
from pilotfish.doctor.following.load import late as late_in
from pilotfish.doctor.following.sight import Sight
from pilotfish.doctor.following.sight import sight as sight_of
from pilotfish.doctor.following.swing import Swing, swing
from pilotfish.doctor.following.watch import Watched

# The last part of the watch decides: what was mended while it was watched is no fault any more.
DECIDING_SHARE = 0.5
_SILENT_S = 1.0  # a coordinator sends every 50 ms at least


@dataclass(frozen=True)
class Numbers:
    """Median and largest of some measurements; NaN without any."""

    median: float = math.nan
    maximum: float = math.nan
    count: int = 0

    @classmethod
    def of(cls, values: Iterable[float]) -> Numbers:
        """Of finite values; others are left out."""
        finite = [value for value in values if math.isfinite(value)]
        return cls(median(finite), max(finite), len(finite)) if finite else cls()


@dataclass(frozen=True)
class Evidence:
    """What the messages of ``seconds`` add up to. Shares are 0 to 1, of the deciding part at the end of the watch."""

    seconds: float
    command_rate_hz: float = 0.0
    status_rate_hz: float = 0.0
    image_rate_hz: dict[str, float] = field(default_factory=dict)  # by channel
    image_sizes: dict[str, dict[tuple[int, int], int]] = field(default_factory=dict)  # channel -> (width, height)
    status_shares: dict[str, float] = field(default_factory=dict)  # by name of the status, the most frequent first
    reason_shares: dict[str, float] = field(default_factory=dict)  # by name of the reason; "none" where it tracks
    last_status: str = ""
    last_reason: str = ""
    sessions: tuple[int, ...] = ()
    rivals: bool = False  # two senders of commands take turns; one after the other is a restart
    silent_at_end_s: float = 0.0  # since the last message of the coordinator, beyond what is usual
    counters_risen: dict[str, int] = field(default_factory=dict)
    base_counters_risen: dict[str, int] = field(default_factory=dict)
    base_rate_hz: float = 0.0
    base_state: str = ""  # of the last base_t: waiting, driving, stopped, fault
    base_states: dict[str, float] = field(default_factory=dict)
    base_text: str = ""
    base_sessions: tuple[int, ...] = ()
    other_bases: tuple[str, ...] = ()  # robots that have a pilotfish-base on the bus
    frame_rate_hz: float = math.nan  # as the coordinator measures it
    latency_s: Numbers = Numbers()
    latency_from_exposure: bool = False
    processing_ms: Numbers = Numbers()
    image_age_s: Numbers = Numbers()  # of stamps with a date, by this host's wall clock
    missed_deadlines: int = 0
    error_first_m: float = math.nan  # wanted - measured distance, positive: too close
    error_last_m: float = math.nan
    setpoint_distance_m: float = math.nan
    setpoint_run: bool = True
    setpoint_taken: bool = False  # by this run of the coordinator; else it is that of its configuration
    pictures_hz: float = 0.0  # new ones that it has looked at, in the deciding part
    late: Late = field(default_factory=Late)  # in the deciding part
    swing: Swing = field(default_factory=Swing)  # of the distance error
    setpoint_bearing_rad: float = math.nan
    sight: Sight = field(default_factory=Sight)  # where the leader was measured, and how it stood
    commanded_mps: Numbers = Numbers()  # of |v|
    commanded_range_mps: tuple[float, float] = (math.nan, math.nan)  # of v, least and most
    commanded_radps: Numbers = Numbers()  # of |w|
    simulated: bool = False  # commands are for a simulator
    wheels_moved: bool | None = None  # by the encoders; None: not measured


def collect(watched: Watched, wall_offset_s: float | None = None) -> Evidence:
    """``wall_offset_s``: wall clock less the clock of the arrivals [s], to tell the age of pictures with a date."""
    late = _late(watched.statuses, watched) or watched.statuses
    late_commands = _late(watched.commands, watched) or watched.commands
    saying = _late(watched.statuses, watched) or late_commands  # commands carry status and reason, too
    statuses = [status for _, status in watched.statuses]
    bases = [base for _, base in watched.bases]
    last = statuses[-1] if statuses else None
    late_bases = [base for _, base in _late(watched.bases, watched)] or bases
    tracked = [(arrival_s, s) for arrival_s, s in watched.statuses if s.status == int(Status.tracking)]
    speeds_mps = [command.linear_mps for _, command in late_commands if math.isfinite(command.linear_mps)]
    deciding_since_s = watched.start_s + watched.seconds * (1.0 - DECIDING_SHARE)
    wanted_m = last.setpoint_distance_m if last else math.nan
    states = [_base_state(base.state) for base in late_bases]
    sessions = tuple(dict.fromkeys(command.session for _, command in watched.commands))
    heard = [arrival_s for arrival_s, _ in (*watched.statuses, *watched.commands)]
    silent_s = watched.start_s + watched.seconds - max(heard) if heard else 0.0
    return Evidence(
        seconds=watched.seconds,
        command_rate_hz=len(watched.commands) / watched.seconds,
        status_rate_hz=len(statuses) / watched.seconds,
        image_rate_hz={name: len(images.heads) / watched.seconds for name, images in watched.images.items()},
        image_sizes={
            name: dict(Counter((width, height) for *_, width, height in images.heads).most_common())
            for name, images in watched.images.items()
        },
        status_shares=_shares(status_name(message.status) for _, message in saying),
        reason_shares=_shares(reason_name(message.reason) for _, message in saying),
        last_status=status_name(saying[-1][1].status) if saying else "",
        last_reason=reason_name(saying[-1][1].reason) if saying else "",
        sessions=sessions,
        rivals=_take_turns([command.session for _, command in watched.commands]),
        silent_at_end_s=silent_s if silent_s > _SILENT_S else 0.0,
        counters_risen=risen(statuses),
        base_counters_risen=risen(bases),
        base_rate_hz=len(bases) / watched.seconds,
        base_state=_base_state(bases[-1].state) if bases else "",
        base_states=_shares(states),
        base_text=bases[-1].text if bases else "",
        base_sessions=tuple(dict.fromkeys(base.session for base in bases)),
        other_bases=tuple(sorted(watched.other_bases)),
        frame_rate_hz=last.frame_rate_hz if last else math.nan,
        latency_s=Numbers.of(status.latency_s for _, status in late),
        latency_from_exposure=bool(last and last.latency_from_exposure),
        processing_ms=Numbers.of(status.processing_ms for _, status in late),
        image_age_s=_image_age(watched, wall_offset_s),
        missed_deadlines=_missed_deadlines(statuses),
        error_first_m=_median_error(tracked[: max(1, len(tracked) // 5)]),
        error_last_m=_median_error(tracked[-max(1, len(tracked) // 5) :]),
        setpoint_distance_m=wanted_m,
        swing=swing([(arrival_s, s.error_m) for arrival_s, s in tracked], wanted_m, deciding_since_s),
        setpoint_bearing_rad=last.setpoint_bearing_rad if last else math.nan,
        sight=sight_of(watched.observations),
        setpoint_run=bool(last.setpoint_run) if last else True,
        setpoint_taken=bool(last and last.setpoint_counter > 0),
        pictures_hz=_pictures([status for _, status in late]) / (watched.seconds * DECIDING_SHARE),
        late=late_in([status for _, status in late]),
        commanded_mps=Numbers.of(map(abs, speeds_mps)),
        commanded_range_mps=(min(speeds_mps), max(speeds_mps)) if speeds_mps else (math.nan, math.nan),
        commanded_radps=Numbers.of(abs(command.angular_radps) for _, command in late_commands),
        simulated=any(command.simulated for _, command in late_commands),
        wheels_moved=_wheels_moved(late_bases),
    )


_STATUSES = {int(status): name for name, status in Status.__members__.items()}
_REASONS = {int(reason): name for name, reason in Reason.__members__.items()}


def status_name(number: int) -> str:
    """Of a status on the wire; a number that this version does not know stays one."""
    return _STATUSES.get(number, f"status {number}")


def reason_name(number: int) -> str:
    """Of a reason on the wire."""
    return _REASONS.get(number, f"reason {number}")


def risen(reports: Sequence[Any]) -> dict[str, int]:
    """How much each counter rose, summed over its senders' sessions; the largest first.

    A message has room for some counters only, and they take turns: the first value of one that is not in the first
    message is 0 unless "others" said that there were more. A session that begins after another counts from 0; of two
    that take turns each has counted before.
    """
    one_by_one = not _take_turns([report.session for report in reports])
    of_session: dict[int, list[Any]] = {}
    for report in reports:
        of_session.setdefault(report.session, []).append(report)
    total: Counter[str] = Counter()
    for k, listed in enumerate(of_session.values()):
        total.update(_risen_in_session(listed, from_zero=one_by_one and k > 0))
    return {name: count for name, count in total.most_common() if count > 0 and name != "others"}


def _risen_in_session(reports: Sequence[Any], *, from_zero: bool) -> dict[str, int]:
    named = {counter.name: counter.count for counter in reports[0].rejected}
    complete = "others" not in named
    first = {} if from_zero else named
    last = dict(first)
    for report in reports:
        for counter in report.rejected:
            if counter.name not in first:
                first[counter.name] = 0 if complete else counter.count
            last[counter.name] = counter.count
    return {name: last[name] - first[name] for name in last}


def _late(messages: list[tuple[float, Any]], watched: Watched) -> list[tuple[float, Any]]:
    since_s = watched.start_s + watched.seconds * (1.0 - DECIDING_SHARE)
    return [(arrival_s, message) for arrival_s, message in messages if arrival_s >= since_s]


def _pictures(statuses: Sequence[Any]) -> int:
    """Reports between pictures repeat the stamp of the last one."""
    return sum(before.utime != after.utime for before, after in pairwise(statuses))


def _shares(names: Iterable[str]) -> dict[str, float]:
    counted = Counter(names)
    return {name: count / counted.total() for name, count in counted.most_common()}


def _take_turns(sessions: Sequence[int]) -> bool:
    """A session comes back after another has spoken; after a restart the old one never does."""
    ended: set[int] = set()
    for before, after in pairwise(sessions):
        if before != after:
            ended.add(before)
        if after in ended:
            return True
    return False


def _missed_deadlines(statuses: Sequence[Any]) -> int:
    """Of the session that spoke last."""
    same = [status for status in statuses if status.session == statuses[-1].session]
    return same[-1].missed_deadlines - same[0].missed_deadlines if same else 0


def _median_error(tracked: Sequence[tuple[float, Any]]) -> float:
    return Numbers.of(status.error_m for _, status in tracked).median


def _image_age(watched: Watched, wall_offset_s: float | None) -> Numbers:
    if wall_offset_s is None:
        return Numbers()
    has_date_us = 1_000_000_000_000_000  # September 2001; a clock that counts from the computer's start is below
    return Numbers.of(
        arrival_s + wall_offset_s - utime / 1e6
        for images in watched.images.values()
        for arrival_s, utime, *_ in images.heads
        if utime > has_date_us
    )


def _base_state(number: int) -> str:
    names = {0: "waiting", 1: "driving", 2: "stopped", 3: "fault"}
    return names.get(number, f"state {number}")


def _wheels_moved(bases: Sequence[Any]) -> bool | None:
    measured = [base for base in bases if base.measured]
    if not measured:
        return None
    return any(abs(base.measured_linear_mps) > 0.01 or abs(base.measured_angular_radps) > 0.02 for base in measured)
