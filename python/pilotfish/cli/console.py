"""What all commands share: where they print, how they show progress, how they end when something is wrong."""

from __future__ import annotations

import errno
import os
import re
import shlex
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import partial
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
    ProgressColumn,
    SpinnerColumn,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.segment import Segment
from rich.table import Table

from pilotfish.cli.progress_lines import progress_lines
from pilotfish.errors import ConfigError, MissingFileError, PilotfishError
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

    def invoke(self, ctx: Any) -> Any:
        """As click's; what is wrong with a number is said with the number and its range."""
        words = [*getattr(ctx, "_protected_args", ()), *ctx.args]
        try:
            return super().invoke(ctx)
        except typer.BadParameter as error:
            if error.message.endswith(_NOT_THERE):
                with friendly_errors():  # one line and the code of a file that is not there, whoever looks for it
                    raise MissingFileError(_of_option(error.param) + _or_a_link(error.message)) from error
            error.message = _said_plainly(error.message, error.param, words)
            raise


def _of_option(param: Any) -> str:
    """Which option it is; nothing of an argument, whose message says "file 'x'" by itself."""
    return f"{'/'.join(param.opts)}: " if param.param_type_name == "option" else ""


def _or_a_link(message: str) -> str:
    """Of what does not exist: that it is there as a link, which leads nowhere or in a circle."""
    named = re.search(r"'(.+)' does not exist", message)
    if named is None or not os.path.islink(named[1]):  # noqa: PTH114
        return message
    try:
        Path(named[1]).stat()
    except OSError as error:
        circle = error.errno == errno.ELOOP
        where = "in a circle" if circle else f"to {os.readlink(named[1])}, which is not there"  # noqa: PTH115
        return f"'{named[1]}' is a symbolic link that leads {where}."
    return message


def _said_plainly(message: str, param: Any, words: list[str]) -> str:
    """The message without the words of the library that checks, and for a bounded number its value and its range."""
    message = message.removeprefix("Value error, ")
    low, high = getattr(param, "min", None), getattr(param, "max", None)
    if not message.startswith("Input should be") or (low is None and high is None):
        return message
    value = _value_of(param.opts, words)
    return f"{value} is not allowed; {_range_text(low, high)} is" if value else message


def _range_text(low: float | None, high: float | None) -> str:
    """The allowed range in words; one of its ends is known."""
    if low is None:
        return f"{high:.10g} or less"
    return f"{low:.10g} or more" if high is None else f"from {low:.10g} to {high:.10g}"


def _value_of(options: list[str], words: list[str]) -> str:
    """What stands behind one of the options on the command line, the last time; empty if that is not found."""
    found = ""
    for at, word in enumerate(words):
        name, equals, value = word.partition("=")
        if name in options:
            found = value if equals else "".join(words[at + 1 : at + 2])
    return found


OnProgress = Callable[[int, int | None], None]

USAGE = 64  # exit code, of sysexits.h
IO_ERROR = 74  # exit code, of sysexits.h
_CLICK_USAGE = 2
_NOT_THERE = " does not exist."  # how click says it
NO_READER = 141  # 128 + SIGPIPE: `| head` has seen enough, as a shell says it


def progress(label: str) -> AbstractContextManager[OnProgress]:
    """A bar on stderr that the yielded function moves: ``step(done, total)``, total None if unknown; with the time so
    far and the time that is left. Without a terminal: a line every few seconds."""
    return _progress(label, MofNCompleteColumn(), in_bytes=False)


def byte_progress(label: str) -> AbstractContextManager[OnProgress]:
    """The same for bytes of a file."""
    return _progress(label, DownloadColumn(), in_bytes=True)


@contextmanager
def working(label: str) -> Iterator[Callable[[str], None]]:
    """Work of a length that is not known: its label on stderr with the time so far, on a terminal only. The yielded
    function changes the label."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=_errors, transient=True, disable=not _errors.is_terminal) as spinner:
        task = spinner.add_task(escape(label), total=None)
        yield lambda text: spinner.update(task, description=escape(text))


@contextmanager
def _progress(label: str, count: ProgressColumn, *, in_bytes: bool) -> Iterator[OnProgress]:
    if not _errors.is_terminal:
        say = partial(_errors.print, markup=False, highlight=False, soft_wrap=True)
        yield progress_lines(label, say, time.monotonic, in_bytes=in_bytes)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), count, TimeElapsedColumn())
    with Progress(*columns, TextColumn("eta"), TimeRemainingColumn(), console=_errors) as bar:
        task = bar.add_task(escape(label), total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def tell(text: str) -> None:
    """One line on stdout that names files: as it is, whatever brackets and numbers stand in it."""
    console.print(text, soft_wrap=True, markup=False, highlight=False)


def tell_next(purpose: str, *words: str | Path) -> None:
    """What to do next, and the command for it as a shell takes it: paths may have spaces."""
    tell(f"next, {purpose}: {shlex.join(map(str, words))}")


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


def warn_of_losses(texts: Sequence[str], most: int = 3) -> None:
    """What a damaged recording has cost, a line each; how many more there are."""
    for text in texts[:most]:
        warn(text)
    if len(texts) > most:
        warn(f"and {len(texts) - most} more damaged places; pilotfish report names them")


@contextmanager
def friendly_errors() -> Iterator[None]:
    """One message that says what to do, and the error's exit code, instead of a traceback. Our own mistakes
    keep theirs."""
    try:
        yield
        _flush()
    except PilotfishError as error:
        _say(_with_meant_key(error))
        raise typer.Exit(error.exit_code) from error
    except OSError as error:
        if error.errno is None:
            raise  # not the system's: a library's own
        if isinstance(error, BrokenPipeError):
            raise typer.Exit(NO_READER) from error
        where = error.filename if error.filename is not None else "cannot write"  # standard output, or a full disk
        _say(f"{where}: {error.strerror}")
        raise typer.Exit(IO_ERROR) from error


def _with_meant_key(error: PilotfishError) -> str:
    if not isinstance(error, ConfigError):
        return str(error)
    from pilotfish.config_message import with_meant_key

    return with_meant_key(str(error))


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
