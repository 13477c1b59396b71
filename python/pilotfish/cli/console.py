"""What all commands share: where they print, how they show progress, how they end when something is wrong."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import typer
import typer.core
from rich.console import Console, ConsoleOptions, RenderableType
from rich.markup import escape
from rich.progress import (
    BarColumn,
    DownloadColumn,
    MofNCompleteColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.segment import Segment
from rich.table import Table

from pilotfish.errors import PilotfishError
from pilotfish.printable import printable


class _Console(Console):
    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Names and texts come from buses and files: a terminal must not obey what stands in them."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else Segment(printable(segment.text), segment.style)

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE))  # like any other error; rich would exit with 1


console = _Console()
_errors = _Console(stderr=True)


class SysexitsGroup(typer.core.TyperGroup):
    """Ends with 64 on a wrong command line, as the C++ programs do and sysexits.h says; click ends with 2."""

    def main(self, *args: Any, **options: Any) -> Any:
        """As click's, with the exit code translated."""
        try:
            return super().main(*args, **options)
        except SystemExit as end:
            raise SystemExit(USAGE if end.code == _CLICK_USAGE else end.code) from end


OnProgress = Callable[[int, int | None], None]

USAGE = 64  # exit code, of sysexits.h
IO_ERROR = 74  # exit code, of sysexits.h
_CLICK_USAGE = 2
NO_READER = 141  # 128 + SIGPIPE: `| head` has seen enough, as a shell says it


@contextmanager
def progress(label: str) -> Iterator[OnProgress]:
    """A bar on stderr that the yielded function moves: ``step(done, total)``, total None if unknown."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=_errors) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def byte_progress(label: str) -> Iterator[OnProgress]:
    """The same for bytes of a file, with the time that is left."""
    columns = (TextColumn("{task.description}"), BarColumn(), DownloadColumn(), TimeRemainingColumn())
    with Progress(*columns, console=_errors) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def share_progress(label: str) -> Iterator[Callable[[str, float], None]]:
    """The same for work in stages, with the time that is left: ``step(stage, share of all that is done)``."""
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=_errors) as bar:
        task = bar.add_task(label, total=1.0)
        yield lambda stage, share: bar.update(task, description=stage, completed=share)


def print_whole(table: Table, width: int) -> None:
    """As wide as it is: for a file or a pipe, where a line has no end."""
    _Console(width=width).print(table)


def warn(message: str) -> None:
    """One line on stderr about something that worked, but not as well as it could."""
    _errors.print(f"[yellow]warning:[/] {escape(message)}", soft_wrap=True)


def check_writable(file: Path) -> None:
    """OSError if ``file`` cannot be written, before hours are spent on what is to stand there. Creates nothing."""
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(file))
    there = file if os.path.lexists(file) else file.parent
    while not os.path.lexists(there):
        there = there.parent
    if there != file and not there.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(there))
    if not os.access(there, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(there))


@contextmanager
def friendly_errors() -> Iterator[None]:
    """One message that says what to do, and the error's exit code, instead of a traceback. Our own mistakes
    keep theirs."""
    try:
        yield
        _flush()
    except PilotfishError as error:
        _say(str(error))
        raise typer.Exit(error.exit_code) from error
    except OSError as error:
        if error.errno is None:
            raise  # not the system's: a library's own
        if isinstance(error, BrokenPipeError):
            raise typer.Exit(NO_READER) from error
        where = error.filename if error.filename is not None else "cannot write"  # standard output, or a full disk
        _say(f"{where}: {error.strerror}")
        raise typer.Exit(IO_ERROR) from error


def run(app: typer.Typer) -> int:
    """The whole command line; its exit code. Also what fails outside of any command, such as printing the help,
    ends with one line."""
    _fill_missing_streams()
    try:
        with friendly_errors():
            try:
                app(prog_name="pilotfish")
            finally:
                _flush()
    except typer.Exit as end:
        code = end.exit_code
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
    _give_up_streams()
    return code


def _say(message: str) -> None:
    with suppress(OSError):  # no reader
        _errors.print(f"[bold red]pilotfish:[/] {escape(message)}", soft_wrap=True)


def _flush() -> None:
    if sys.stdout is not None:
        sys.stdout.flush()


def _fill_missing_streams() -> None:
    """Else the next file that is opened gets the number 1, and what is printed lands in it."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)


def _give_up_streams() -> None:
    """What could not be written by now never will be; Python would try once more, and complain."""
    for stream, descriptor in ((sys.stdout, 1), (sys.stderr, 2)):
        try:
            if stream is not None:
                stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)
