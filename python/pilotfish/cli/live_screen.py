"""What every calibration with a camera that runs shares: a screen that is drawn again and again, and the Enter key."""

from __future__ import annotations

import contextlib
import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from rich.console import RenderableType
from rich.live import Live
from rich.text import Text

from pilotfish.cli.console import console
from pilotfish.errors import CalibrationError

_REFRESH_HZ = 8
State = TypeVar("State")


@contextmanager
def live_screen(
    first: str, draw: Callable[[State], RenderableType], say: Callable[[State], None]
) -> Iterator[Callable[[State], None]]:
    """A function that shows a state: on a terminal ``draw`` of it in place of the last, else by ``say``."""
    if not console.is_terminal:
        yield say
        return
    with Live(Text(first), console=console, refresh_per_second=_REFRESH_HZ) as live:
        yield lambda state: live.update(draw(state))


@contextmanager
def enter_key() -> Iterator[Callable[[], bool]]:
    """A function that says whether Enter was pressed since it was last asked. On a terminal keys are not echoed
    meanwhile: a line break would shift what is drawn. CalibrationError where there is nothing to press it on."""
    try:
        descriptor = sys.stdin.fileno()
    except (AttributeError, OSError, ValueError):  # closed, or replaced by something that is no file
        raise _no_enter() from None
    with _without_echo(descriptor):
        yield lambda: _pressed(descriptor)


def _pressed(descriptor: int) -> bool:
    if not select.select([descriptor], [], [], 0.0)[0]:
        return False
    typed = os.read(descriptor, 1024)
    if not typed:
        raise _no_enter()
    return b"\n" in typed


def _no_enter() -> CalibrationError:
    return CalibrationError(
        "a camera that runs needs somebody who presses Enter, and standard input has ended: run it in a terminal, or "
        "film the turn and the drive (SOURCE, --straight)"
    )


@contextmanager
def _without_echo(descriptor: int) -> Iterator[None]:
    if not os.isatty(descriptor):
        yield
        return
    import termios

    before = termios.tcgetattr(descriptor)
    quiet = list(before)
    quiet[3] &= ~termios.ECHO
    termios.tcsetattr(descriptor, termios.TCSADRAIN, quiet)
    try:
        yield
    finally:
        with contextlib.suppress(termios.error):  # the terminal was closed
            termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
