"""A recording as one stream of rows, whoever wrote it. Nothing is held but what is not complete yet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

from pilotfish.black_box.log import Damage, Event
from pilotfish.errors import RecordingError
from pilotfish.logs.losses import Loss
from pilotfish.logs.messages import Message, decode, is_unreadable, kind_of, robot_of
from pilotfish.logs.notes import RunNotes
from pilotfish.logs.robot_sift import RobotSift
from pilotfish.logs.sources import OnProgress, events_of, recordings_in, size_of


@dataclass(frozen=True)
class Row:
    """One row of one table (a key of columns.TABLES). A column that is not in ``values`` is not known."""

    robot: str
    table: str
    values: dict[str, Any]
    tags: tuple[dict[str, Any], ...] = ()  # of a frame: its rows of "tags", which follow


def rows_in(
    path: str | Path, robot: str | None = None, notes: RunNotes | None = None, on_progress: OnProgress | None = None
) -> Iterator[Row]:
    """Every row of a recording; of each table in the order of time. ``notes`` is filled on the way.

    MissingFileError, RecordingError if there is no event in it.
    """
    for item in everything_in(path, robot, RunNotes() if notes is None else notes, on_progress):
        if isinstance(item, Row):
            yield item


def everything_in(
    path: str | Path, robot: str | None, notes: RunNotes, on_progress: OnProgress | None = None
) -> Iterator[Row | Message | Event]:
    """The same rows, and between them each message that was decoded, and each event with an image, which is not."""
    recordings = recordings_in(Path(path), robot)
    total = sum(map(size_of, recordings))
    start_utime = _start_of(recordings)
    if start_utime is None:
        raise RecordingError(f"{path}: no event of LCM in it: neither a black box's file nor one of lcm-logger")
    notes.start_utime = start_utime
    before, heard = 0, False
    for files in recordings:
        for item in _Sifting(notes, robot).items(events_of(files, before, total, on_progress)):
            heard = True
            yield item
        before += size_of(files)
    if not heard:
        channels = ", ".join(sorted(notes.events)[:10]) or "none"
        whose = f"of robot '{robot}'" if robot else "of Pilotfish"
        raise RecordingError(f"{path}: no message {whose} in it; channels in it: {channels}")


class _Sifting:
    """One file after the other, for all robots that are in them."""

    def __init__(self, notes: RunNotes, robot: str | None) -> None:
        self._notes = notes
        self._only = robot.lower() if robot else None
        self._sifts: dict[str, RobotSift] = {}

    def items(self, events: Iterator[Event | Damage]) -> Iterator[Row | Message | Event]:
        utime, last_utime = self._notes.start_utime, None
        losses = self._notes.losses
        for event in events:
            if isinstance(event, Damage):
                losses.append(Loss(event, last_utime))
                text = f"{event.size} bytes of {event.file.name} are no events, from byte {event.offset} on"
                for name, sift in self._sifts.items():
                    yield from _named(name, sift.note(utime, "damage", text))
                continue
            utime = last_utime = event.utime
            if losses and losses[-1].before_utime is None:
                losses[-1].before_utime = utime
            item = self._item(event)
            if item is None:
                continue
            yield item
            if isinstance(item, Message):
                if item.robot not in self._sifts:
                    self._sifts[item.robot] = RobotSift(self._notes.start_utime, self._notes.of(item.robot))
                yield from _named(item.robot, self._sifts[item.robot].take(item))
        for name, sift in self._sifts.items():
            yield from _named(name, sift.end())

    def _item(self, event: Event) -> Message | Event | None:
        self._notes.events[event.channel] += 1
        kind = kind_of(event)
        if kind is None:
            self._notes.unreadable += is_unreadable(event)
            return None
        if self._only not in (None, robot_of(event.channel, kind)):
            return None
        if kind == "IMAGE":
            self._notes.cameras[robot_of(event.channel, kind)] += 1
            return event
        message = decode(event, kind)
        if message is not None:
            self._notes.channels_of.setdefault(message.robot, set()).add(event.channel)
        self._notes.unreadable += message is None
        return message


def _named(robot: str, rows: list[tuple[str, dict[str, Any]]]) -> Iterator[Row]:
    for at, (table, values) in enumerate(rows):
        tags = takewhile(lambda row: row[0] == "tags", rows[at + 1 :]) if table == "frames" else ()
        yield Row(robot, table, values, tuple(tag for _, tag in tags))


def _start_of(recordings: list[list[Path]]) -> int | None:
    """When the first of them begins [us of the wall clock]; None if there is no event in any."""
    starts = []
    for files in recordings:
        events = (event for event in events_of(files, 0, 0, None) if isinstance(event, Event))
        starts += [event.utime for event in [next(events, None)] if event is not None]
    return min(starts, default=None)
