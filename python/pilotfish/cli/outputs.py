"""What commands write: looked at before the work, and named after it, by one rule (docs/operating-guide.md, "Files that
commands write")."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import typer

from pilotfish.cli.console import friendly_errors, tell
from pilotfish.whole_files import check_not_among, missing_folders

PICTURES = (".png", ".svg", ".pdf")


@dataclass(frozen=True)
class Output:
    """A file that is going to be written; ``note`` says what else that changes."""

    file: Path
    note: str = ""

    def wrote(self, what: str = "") -> None:
        """One line, once it has been written; ``what``: what is in it."""
        tell(f"wrote {self.file}{self.note}{what and f': {what}'}")


def output_file(file: Path, inputs: Iterable[Path] = ()) -> Output:
    """Before the work: OSError if ``file`` cannot be written, ExistsError if it is one of the ``inputs``. It is tried;
    nothing of that stays."""
    _check_file(file)
    check_not_among(file, inputs)
    return Output(file, " (replaced)" if file.is_file() else in_new_folder(file))


def output_beside(file: Path) -> Output:
    """The same for a file that is written beside another, or into a folder that is an output itself: which folder is
    new is said of that one."""
    _check_file(file)
    return Output(file, " (replaced)" if file.is_file() else "")


def in_new_folder(file: Path) -> str:
    """What is said of a file, or a folder, for which a folder must be made; empty if none must."""
    missing = missing_folders(file)
    return f" (in the new folder {missing[0]})" if missing else ""


def output_picture(file: Path, option: str = "--out") -> Output:
    """The same for a picture, whose ending says the format: a wrong one is a wrong command line."""
    if file.suffix.lower() not in PICTURES:
        raise typer.BadParameter(f"{option}: '{file.name}' ends in none of {', '.join(PICTURES)}")
    return output_file(file)


class OutputFolder:
    """A folder that several files are written to; it remembers which of them had been there."""

    def __init__(self, folder: Path) -> None:
        self._before = frozenset(folder.iterdir()) if folder.is_dir() else frozenset()

    def wrote(self, file: Path) -> None:
        """One line, once a file has been written."""
        Output(file, " (replaced)" if file in self._before else "").wrote()


def output_folder(folder: Path) -> OutputFolder:
    """Before the work: OSError if the folder cannot be made or written to. Nothing of the trial stays."""
    _try_folder(folder, folder)
    return OutputFolder(folder)


def writable_folder(folder: Path | None) -> Path | None:
    """The same as the callback of an option."""
    if folder is not None:
        with friendly_errors():
            output_folder(folder)
    return folder


def _check_file(file: Path) -> None:
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(file))
    if os.path.lexists(file) and not os.access(file, os.W_OK):
        why = errno.EACCES if file.exists() else errno.ENOENT  # a link to nowhere, or to itself
        raise OSError(why, os.strerror(why), str(file))
    if not os.path.lexists(file) or file.is_file():  # else a device or a pipe, beside which nothing is written
        _try_folder(file.parent, file)


def _try_folder(folder: Path, wanted: Path) -> None:
    """A file in ``folder``, made and removed: permissions alone do not tell, as for root in /proc."""
    missing = missing_folders(folder / "any")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        there = next(each for each in (folder, *folder.parents) if os.path.lexists(each))
        why = error.errno if there.is_dir() else errno.ENOTDIR
        said = f"nothing can be written in {there}: {os.strerror(why or errno.EIO)}"
        raise OSError(why, said, str(wanted)) from error
    finally:
        for made in missing:
            with suppress(OSError):  # never made
                made.rmdir()
