"""What all commands share: where they print, how they show progress, how they end when something is wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from pilotfish.errors import PilotfishError

console = Console()
_errors = Console(stderr=True)

OnProgress = Callable[[int, int | None], None]


@contextmanager
def progress(label: str) -> Iterator[OnProgress]:
    """A bar on stderr that the yielded function moves: ``step(done, total)``, total None if unknown."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=_errors) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def warn(message: str) -> None:
    """One line on stderr about something that worked, but not as well as it could."""
    _errors.print(f"[yellow]warning:[/] {escape(message)}", soft_wrap=True)


IO_ERROR = 74  # exit code, of sysexits.h


@contextmanager
def friendly_errors() -> Iterator[None]:
    """One message that says what to do, and the error's exit code, instead of a traceback. Our own mistakes
    keep theirs."""
    try:
        yield
    except PilotfishError as error:
        _errors.print(f"[bold red]pilotfish:[/] {escape(str(error))}", soft_wrap=True)
        raise typer.Exit(error.exit_code) from error
    except OSError as error:
        if error.filename is None:
            raise  # no file of the user's
        _errors.print(f"[bold red]pilotfish:[/] {escape(f'{error.filename}: {error.strerror}')}", soft_wrap=True)
        raise typer.Exit(IO_ERROR) from error
