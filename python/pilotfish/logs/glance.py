"""What kinds of messages a recording holds, from the headers of its events: nothing is decoded, pictures are skipped
over, and it ends as soon as it has seen what is wanted. A log without it is known after 1 s per million events, where
reading it takes 20 s."""

from __future__ import annotations

import mmap
import struct
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path

from pilotfish.errors import RecordingError
from pilotfish.logs.messages import FINGERPRINTS, robot_of
from pilotfish.logs.sources import recordings_in

FRAMES = frozenset({"STEP", "OBSERVATION", "STATUS"})  # each makes a frame of a coordinator
COMMANDS = frozenset({"STEP", "SENT", "COMMAND"})
_HEADER = struct.Struct(">I16xii")  # of an event: sync word, (number, time), letters of the channel, bytes of data
_HEADER_BYTES = 28
_SYNC = 0xEDA1DA01
_MAX_LETTERS = 63
_MOST_CHANNELS = 1000


def check_recorded(path: str | Path, robot: str | None = None, *, commands: bool = False) -> None:
    """RecordingError if no coordinator's frame (of ``robot``), or with ``commands`` no command, can be in it; whatever
    else may be wrong with it is for read_run(). MissingFileError."""
    wanted = [FRAMES, *([COMMANDS] if commands else [])]
    missing, channels = missing_kinds(path, robot, wanted)
    if not missing:
        return
    whose = f" of robot '{robot}'" if robot else " of a coordinator"
    if FRAMES in missing:
        listed = ", ".join(sorted(channels)[:10]) or "none"
        more = f" and {len(channels) - 10} more" if len(channels) > 10 else ""
        raise RecordingError(f"{path}: no frame{whose} in it; channels in it: {listed}{more}")
    raise RecordingError(
        f"{path}: no command{whose} is recorded: record NAME_COMMAND too, or use the black box (pilotfish-coordinator "
        "--record DIR)"
    )


def missing_kinds(
    path: str | Path, robot: str | None, wanted: Collection[frozenset[str]]
) -> tuple[set[frozenset[str]], set[str]]:
    """(the sets of kinds, keys of messages.TYPES, of which none is in the recording; the channels that were come by).
    What lies behind a damaged place may be anything: then nothing is missing."""
    missing, channels = set(wanted), set[bytes]()
    only = robot.lower() if robot else None
    for files in recordings_in(Path(path), robot):
        for file in files:
            with suppress(FileNotFoundError):  # a ring has deleted it meanwhile
                if file.stat().st_size and not _look_into(file, only, missing, channels):
                    return set(), set()
            if not missing:
                return missing, set()
    return missing, {channel.decode("ascii", "replace") for channel in channels}


def _look_into(file: Path, only: str | None, missing: set[frozenset[str]], channels: set[bytes]) -> bool:
    """Takes from ``missing`` what is in the file; whether it could be followed to the last whole event."""
    kinds = {fingerprint: kind for fingerprint, kind in FINGERPRINTS.items() if any(kind in each for each in missing)}
    unpack, seen = _HEADER.unpack_from, set()
    with file.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        at, end = 0, len(data)
        while at + _HEADER_BYTES <= end:
            sync, letters, size = unpack(data, at)
            if sync != _SYNC or not 1 <= letters <= _MAX_LETTERS or size < 0:
                return False
            begin = at + _HEADER_BYTES + letters
            head = data[at + _HEADER_BYTES : begin + 8]  # channel, and the fingerprint if it is a message
            at = begin + size
            if head in seen or at > end:
                continue
            if len(seen) < _MOST_CHANNELS:
                seen.add(head)
            channel, kind = head[:letters], kinds.get(head[letters:])
            if len(channels) < _MOST_CHANNELS:
                channels.add(channel)
            if kind is not None and only in (None, robot_of(channel.decode("ascii", "replace"), kind)):
                missing -= {each for each in missing if kind in each}
                if not missing:
                    return True
    return True
