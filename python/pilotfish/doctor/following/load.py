"""Whether the computer has too much to do: its load, and what the coordinator itself counts as late."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from pilotfish.logs.notes import STAGE_LIMITS_MS

LATE_BEAT_MS, LONG_WAIT_MS = 4.0, 16.0  # the sender allows for 6 ms; half a period of 30 Hz
_OFTEN, _FEW = 0.05, 3  # share of the late ones, and how many at least, that are no coincidence
_BUSY, _LOADED = 0.9, 1.5  # share of the processors' time; load average by core


class Reads(Protocol):
    """What is needed of doctor.host.Host."""

    def read(self, name: str) -> str | None:
        """The text of a file, None if it cannot be read."""


@dataclass(frozen=True)
class Machine:
    """The computer that the coordinator runs on. ``busy_share``: of all processors' time during the watch, 0 to 1."""

    cores: int
    load_average: float  # of the last minute
    busy_share: float
    receive_buffer_bytes: int | None  # net.core.rmem_max; None: cannot be read

    @property
    def overloaded(self) -> bool:
        """More wants to run than there are processors, and did during the watch."""
        return self.busy_share >= _BUSY and self.load_average >= _LOADED * self.cores

    def __str__(self) -> str:
        cores = f"{self.cores} {'core' if self.cores == 1 else 'cores'}"
        return f"load average {self.load_average:.1f} on {cores}, {100 * self.busy_share:.0f} % busy"


@dataclass(frozen=True)
class Late:
    """Of the coordinator's own counts, how many rose during the watch, and how many of those were late."""

    beats: int = 0  # commands between pictures
    late_beats: int = 0  # sent LATE_BEAT_MS or more after they were due
    pictures: int = 0
    long_waits: int = 0  # pictures that waited for LONG_WAIT_MS or longer before they were looked at

    @property
    def overloaded(self) -> bool:
        """Late too often for a coincidence."""
        beats = self.late_beats >= max(_FEW, _OFTEN * self.beats)
        return beats or self.long_waits >= max(_FEW, _OFTEN * self.pictures)

    def texts(self) -> list[str]:
        """Of what was late; nothing of what was not."""
        said = []
        if self.late_beats:
            said.append(
                f"{self.late_beats} of {self.beats} commands between pictures left {LATE_BEAT_MS:g} ms late or more"
            )
        if self.long_waits:
            said.append(
                f"{self.long_waits} of {self.pictures} pictures waited {LONG_WAIT_MS:g} ms or longer before they were "
                "looked at"
            )
        return said


def late(statuses: Sequence[Any]) -> Late:
    """From the stages of status_t, which count since the program's start: last less first, of one session."""
    if not statuses:
        return Late()
    same = [status for status in statuses if status.session == statuses[-1].session]
    first, last = _counts(same[0]), _counts(same[-1])
    risen = {name: [b - a for a, b in zip(first.get(name, [0] * 11), last[name], strict=True)] for name in last}
    beats, waits = risen.get("beats_late", [0] * 11), risen.get("waited", [0] * 11)
    return Late(sum(beats), _at_least(beats, LATE_BEAT_MS), sum(waits), _at_least(waits, LONG_WAIT_MS))


def cpu_times(host: Reads) -> tuple[int, int] | None:
    """(busy, all) of all processors since the computer's start, in ticks; None where it cannot be read."""
    line = (host.read("/proc/stat") or "").partition("\n")[0].split()
    if line[:1] != ["cpu"] or len(line) < 5 or not all(word.isdigit() for word in line[1:]):
        return None
    ticks = [int(word) for word in line[1:9]]  # guests' time is in user's already
    idle = ticks[3] + (ticks[4] if len(ticks) > 4 else 0)  # waiting for a disk is idleness, too
    return sum(ticks) - idle, sum(ticks)


def machine_load(host: Reads, before: tuple[int, int] | None) -> Machine | None:
    """Now, and the share since ``before``; None where it cannot be read."""
    after = cpu_times(host)
    words = (host.read("/proc/loadavg") or "").split()
    if before is None or after is None or not words:
        return None
    cores = sum(line.startswith("cpu") for line in (host.read("/proc/stat") or "").splitlines()) - 1
    buffer = host.read("/proc/sys/net/core/rmem_max") or ""
    try:
        load_average = float(words[0])
    except ValueError:
        return None
    return Machine(
        cores=max(1, cores),
        load_average=load_average,
        busy_share=(after[0] - before[0]) / max(1, after[1] - before[1]),
        receive_buffer_bytes=int(buffer) if buffer.isdigit() else None,
    )


def _counts(status: Any) -> dict[str, list[int]]:
    return {stage.name: list(stage.counts) for stage in status.stages}


def _at_least(counts: Sequence[int], limit_ms: float) -> int:
    return sum(counts[STAGE_LIMITS_MS.index(limit_ms) + 1 :])
