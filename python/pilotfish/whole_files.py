"""Files that are there whole or not at all, and not in place of what is still wanted."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pilotfish.errors import ExistsError


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


def write_whole(file: str | Path, text: str) -> None:
    """The text as UTF-8. OSError if it cannot be written; then what was there before stays."""
    with written_whole(Path(file)) as partial:
        partial.write_text(text, encoding="utf-8")


def check_same(file: Path, text: str, option: str) -> None:
    """ExistsError if ``file`` is there and says something else than ``text``; ``option`` replaces it all the same."""
    if file.is_file() and file.read_bytes() != text.encode():
        raise ExistsError(
            f"{file} is there already and says something else: name another file, or replace it with {option}"
        )


def check_not_among(file: Path, inputs: Iterable[Path]) -> None:
    """ExistsError if ``file`` is one of the inputs, which what is written there would destroy."""
    if file.exists() and any(file.samefile(each) for each in inputs if each.exists()):
        raise ExistsError(f"{file} is what is read: name another file to write")
