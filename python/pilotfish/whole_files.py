"""Files that are there whole or not at all, and not in place of what is still wanted."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pilotfish.errors import ExistsError

_ENDING = ".part"


@contextmanager
def written_whole(file: Path) -> Iterator[Path]:
    """Where to write: beside ``file``, which it becomes at the end. On an error, or Ctrl-C, nothing of it stays, nor a
    folder that was made for it; what a killed process has left of the same file is removed by the next that writes it.
    An OSError of writing, such as a full disk's, names ``file``."""
    if os.path.lexists(file) and not file.is_file():
        with _named(file, file):
            yield file  # a device or a pipe: nothing to replace
        return
    partial = file.with_name(f".{file.name}.{os.getpid()}{_ENDING}")
    with _named(file, partial), folder_for(file):
        _remove_abandoned(file)
        with partial.open("wb") as mine:  # its lock tells others that somebody still writes there
            with suppress(OSError):
                fcntl.flock(mine, fcntl.LOCK_EX | fcntl.LOCK_NB)
            try:
                yield partial
                partial.replace(file)
            finally:
                with suppress(FileNotFoundError):
                    partial.unlink()


@contextmanager
def folder_for(file: Path) -> Iterator[None]:
    """Makes the folders that are missing above ``file``, and on an error removes those of them that are empty."""
    missing = missing_folders(file)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        for folder in missing:
            with suppress(OSError):  # never made, or no longer empty
                folder.rmdir()
        raise


def missing_folders(file: Path) -> list[Path]:
    """Those above ``file`` that are not there, the innermost first."""
    return [folder for folder in file.parents if not os.path.lexists(folder)]


@contextmanager
def _named(file: Path, partial: Path) -> Iterator[None]:
    """What the system says of ``partial``, or of no file at all, it says of ``file``: that is the name people know."""
    try:
        yield
    except OSError as error:
        if error.errno is not None and error.filename in (None, str(partial), os.fsencode(partial)):
            raise OSError(error.errno, error.strerror, str(file)) from error
        raise


def _remove_abandoned(file: Path) -> None:
    """Removes partial files of ``file`` that no process holds: the system releases a lock when its holder dies."""
    with suppress(OSError):  # a folder that cannot be listed
        for other in file.parent.iterdir():
            begin, end = f".{file.name}.", _ENDING
            if not (other.name.startswith(begin) and other.name.endswith(end)):
                continue
            if not other.name[len(begin) : -len(end)].isdecimal() or other.is_symlink():
                continue
            with suppress(OSError), other.open("rb") as held:  # another's, or of a file system without locks
                fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
                other.unlink()


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
