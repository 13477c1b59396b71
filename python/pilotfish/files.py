"""Reading untrusted files: bounded, and without waiting for what never comes."""

from __future__ import annotations

from pathlib import Path

from pilotfish import core
from pilotfish.errors import MissingFileError, PilotfishError

MAX_TEXT_BYTES = 256 * 2**20  # a recording of a day


def read_text(file: str | Path, error: type[PilotfishError] = MissingFileError) -> str:
    """The UTF-8 text of a regular file; ``error`` with what is wrong otherwise. Directories, pipes, sockets and devices
    are refused, and so is what is larger than MAX_TEXT_BYTES."""
    try:
        return core.read_file(file, MAX_TEXT_BYTES).decode("utf-8")
    except UnicodeDecodeError as problem:
        raise error(f"{file}: not a text in UTF-8 (byte {problem.start})") from problem
    except ValueError as problem:
        raise error(str(problem)) from problem
