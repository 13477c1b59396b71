"""The files of a recording, whoever wrote them, and how far one has read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from pilotfish.black_box.log import Damage, Event, events_in, files_in, robots_in
from pilotfish.errors import MissingFileError

OnProgress = Callable[[int, int | None], None]  # bytes read, bytes in all
_SAY_EVERY = 200  # events


def recordings_in(path: Path, robot: str | None = None) -> list[list[Path]]:
    """The files to read one after the other; one list for every robot that recorded into a folder.

    MissingFileError if there is nothing there."""
    if not path.exists():
        raise MissingFileError(f"{path}: no such file or folder")
    if path.is_dir():
        robots = robots_in(path)
        if robot is None and len(robots) > 1:
            return [files_in(path, name) for name in robots]
    elif not path.is_file():
        raise MissingFileError(f"{path}: neither a file nor a folder")
    return [files_in(path, robot if path.is_dir() else None)]


def size_of(files: list[Path]) -> int:
    """Bytes in all; a ring that still records may have deleted some meanwhile."""
    return sum(file.stat().st_size for file in files if file.exists())


def events_of(
    files: list[Path], said_before: int, total: int, on_progress: OnProgress | None
) -> Iterator[Event | Damage]:
    """Every event of these files, but of those that a ring has deleted meanwhile. Progress counts from ``said_before``
    [bytes]."""
    before = said_before
    for file in files:
        size = size_of([file])
        with suppress(MissingFileError):
            for count, event in enumerate(events_in(file)):
                if on_progress and count % _SAY_EVERY == 0:
                    on_progress(before + event.offset, total)
                yield event
        before += size
    if on_progress:
        on_progress(before, total)
