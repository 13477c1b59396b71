"""Files of LCM events, as lcm-logger and the black box write them, read past any damage. Per event, big endian:

int32 sync word 0xEDA1DA01, int64 number, int64 time [us], int32 letters of the channel, int32 bytes of data, channel,
data.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pilotfish.errors import MissingFileError, RecordingError

_SYNC = b"\xed\xa1\xda\x01"
_HEADER = struct.Struct(">4sqqii")
_MAX_CHANNEL_LETTERS = 63
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


def _events_of(file: Path) -> Iterator[Event | Damage]:
    with file.open("rb") as stream:
        content = stream.read()
    offset = 0
    while offset < len(content):
        event = _event_at(content, offset, file)
        if event is not None:
            yield event
            offset += _HEADER.size + len(event.channel) + len(event.data)
            continue
        begin = offset
        while True:
            found = content.find(_SYNC, offset + 1)
            offset = len(content) if found < 0 else found
            if offset == len(content) or _event_at(content, offset, file) is not None:
                break
        yield Damage(file, begin, offset - begin, at_end=offset == len(content))


def _event_at(content: bytes, offset: int, file: Path) -> Event | None:
    if offset + _HEADER.size > len(content):
        return None
    sync, _, utime, letters, size = _HEADER.unpack_from(content, offset)
    data = offset + _HEADER.size + letters
    if sync != _SYNC or not 1 <= letters <= _MAX_CHANNEL_LETTERS or size < 0 or data + size > len(content):
        return None
    channel = content[data - letters : data]
    if not channel.isascii():
        return None
    return Event(file, offset, utime, channel.decode("ascii"), content[data : data + size])
