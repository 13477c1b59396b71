"""Files of LCM events, as lcm-logger and the black box write them, read past any damage. Per event, big endian:

int32 sync word 0xEDA1DA01, int64 number, int64 time [us], int32 letters of the channel, int32 bytes of data, channel,
data.
"""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from pilotfish.errors import MissingFileError, RecordingError

_SYNC = b"\xed\xa1\xda\x01"
_HEADER = struct.Struct(">4sqqii")
_MAX_CHANNEL_LETTERS = 63
_SCANNED_BYTES = 1 << 20
_SEGMENT = re.compile(r"(?P<robot>\w+)-(?P<start>\d+)-(?P<number>\d+)\.lcmlog")


@dataclass(frozen=True)
class Event:
    """One event of a recording, with the place in its file at which it begins [bytes]."""

    file: Path
    offset: int
    utime: int  # wall clock, when it was recorded
    channel: str
    data: bytes


@dataclass(frozen=True)
class Damage:
    """Bytes that are no events: a disk's fault, or a program that was killed while it wrote."""

    file: Path
    offset: int
    size: int
    at_end: bool


def events_in(path: str | Path, robot: str | None = None) -> Iterator[Event | Damage]:
    """Of a file, or of all files of a robot's ring in a folder, oldest first. MissingFileError, RecordingError."""
    for file in files_in(Path(path), robot):
        yield from _events_of(file)


def files_in(path: Path, robot: str | None = None) -> list[Path]:
    """The files of a recording, oldest first; a file is its own recording.

    MissingFileError if there are none, RecordingError if several robots are recorded there and none is named.
    """
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise MissingFileError(f"{path}: no such file or folder")
    found = [(match, file) for file in path.iterdir() if (match := _SEGMENT.fullmatch(file.name))]
    robots = sorted({match["robot"] for match, _ in found})
    if not found or (robot is not None and robot not in robots):
        wanted = "a black box" if robot is None else f"the black box of '{robot}'"
        raise MissingFileError(f"{path}: no file of {wanted} (ROBOT-START-NUMBER.lcmlog) there")
    if robot is None and len(robots) > 1:
        raise RecordingError(f"{path}: several robots recorded here, name one with --robot: {', '.join(robots)}")
    chosen = robot or robots[0]
    own = [(int(match["start"]), int(match["number"]), file) for match, file in found if match["robot"] == chosen]
    return [file for _, _, file in sorted(own)]


def program_start_utime(file: Path) -> int | None:
    """When the program started that wrote this file of a ring [us of the wall clock]; None: the name does not say."""
    match = _SEGMENT.fullmatch(file.name)
    return int(match["start"]) if match else None


def earlier_files(file: Path) -> list[Path]:
    """Files of the same ring and start that come before this one and are still there, oldest first."""
    match = _SEGMENT.fullmatch(file.name)
    if match is None:
        return []
    found = ((_SEGMENT.fullmatch(other.name), other) for other in file.parent.iterdir())
    same = [
        (int(own["number"]), other)
        for own, other in found
        if own and (own["robot"], own["start"]) == (match["robot"], match["start"])
    ]
    return [other for number, other in sorted(same) if number < int(match["number"])]


def robots_in(folder: Path) -> list[str]:
    """The robots whose rings are in a folder, by name."""
    return sorted({match["robot"] for path in folder.iterdir() if (match := _SEGMENT.fullmatch(path.name))})


def _events_of(file: Path) -> Iterator[Event | Damage]:
    """One event in memory at a time: lcm-logger's files with images hold gigabytes."""
    with file.open("rb") as stream:
        end = os.fstat(stream.fileno()).st_size  # of a file that grows: what was there at first
        offset = 0
        while offset < end:
            event = _event_at(stream, offset, end, file)
            if event is not None:
                yield event
                offset += _HEADER.size + len(event.channel) + len(event.data)
                continue
            begin = offset
            while True:
                offset = _next_sync(stream, offset + 1, end)
                if offset == end or _event_at(stream, offset, end, file) is not None:
                    break
            yield Damage(file, begin, offset - begin, at_end=offset == end)


def _event_at(stream: BinaryIO, offset: int, end: int, file: Path) -> Event | None:
    if offset + _HEADER.size > end:
        return None
    stream.seek(offset)
    header = stream.read(_HEADER.size)
    if len(header) < _HEADER.size:
        return None
    sync, _, utime, letters, size = _HEADER.unpack(header)
    data = offset + _HEADER.size + letters
    if sync != _SYNC or not 1 <= letters <= _MAX_CHANNEL_LETTERS or size < 0 or data + size > end:
        return None
    channel = stream.read(letters)
    content = stream.read(size)
    if len(channel) < letters or len(content) < size or not channel.isascii():
        return None
    return Event(file, offset, utime, channel.decode("ascii"), content)


def _next_sync(stream: BinaryIO, offset: int, end: int) -> int:
    """Where the next sync word begins, at ``offset`` or later; ``end`` if there is none."""
    while offset < end:
        stream.seek(offset)
        chunk = stream.read(min(_SCANNED_BYTES, end - offset))
        found = chunk.find(_SYNC)
        if found >= 0:
            return offset + found
        if len(chunk) < _SCANNED_BYTES:
            return end
        offset += len(chunk) - len(_SYNC) + 1  # the word may begin in the last three bytes
    return end
