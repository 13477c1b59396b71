"""While a camera is calibrated: a map of where the board has been, and what to do next."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Group
from rich.panel import Panel
from rich.text import Text

from pilotfish.calibration.camera import Progress
from pilotfish.cli.console import tell
from pilotfish.cli.live_screen import live_screen


@contextmanager
def live_map() -> Iterator[Callable[[Progress], None]]:
    """On a terminal a map that is drawn again and again; else one line for each view that is taken."""
    with live_screen("looking for the board; Ctrl-C ends", drawn, _line_by_line()) as show:
        yield show


def drawn(state: Progress) -> Group:
    """The map as it stands: a blank where the board has not been yet."""
    view = "view" if state.views == 1 else "views"
    said = f"{state.views} {view}, {state.coverage.share:.0%} of the picture; the board: {state.last}"
    map_ = Panel.fit("\n".join(state.coverage.text()), title="seen so far")
    return Group(map_, Text(said), Text(f"next: {state.advice}"), Text("Ctrl-C ends it and calibrates", style="dim"))


def _line_by_line() -> Callable[[Progress], None]:
    shown = 0

    def show(state: Progress) -> None:
        nonlocal shown
        if state.views > shown:
            shown = state.views
            said = f"view {state.views}: {state.coverage.share:.0%} of the picture; next: {state.advice}"
            tell(said)

    return show
