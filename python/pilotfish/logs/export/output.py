"""A file that is there whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def written_whole(file: Path) -> Iterator[Path]:
    """Where to write: beside ``file``, which it becomes at the end. On an error, or Ctrl-C, nothing of it stays."""
    if os.path.lexists(file) and not file.is_file():
        yield file  # a device or a pipe: nothing to replace
        return
    file.parent.mkdir(parents=True, exist_ok=True)
    partial = file.with_name(f".{file.name}.{os.getpid()}.part")
    try:
        yield partial
        partial.replace(file)
    finally:
        with suppress(FileNotFoundError):
            partial.unlink()
