"""While a mounting is calibrated with a camera that runs: what to do now, and how much of it is done."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Group
from rich.panel import Panel
from rich.text import Text

from pilotfish.calibration.mounting.calibrate import SMALL_DRIVE_M, SMALL_TURN_RAD
from pilotfish.calibration.mounting.live import AIM_DRIVE, AIM_TURN, DRIVE, TURN, LiveState
from pilotfish.cli.console import tell
from pilotfish.cli.live_screen import live_screen

_EVERY_PICTURES = 20  # without a terminal: a line
_SCALE = 40  # columns that stand for the picture's width

_TODO = {
    AIM_TURN: "Turn the robot until a tag is near one side of the picture, and let it stand. Enter: begin.",
    TURN: "Let it turn on the spot, slowly, until the tag has passed to the other side. Enter: done.",
    AIM_DRIVE: "Let the robot face the tag, 1 to 2 m from it, and stand. Enter: begin.",
    DRIVE: "Drive straight {way} the tag, slowly, for half a metre or more. Enter: done.",
}


@contextmanager
def mounting_screen(width_px: int, *, turn_only: bool, backwards: bool) -> Iterator[Callable[[LiveState], None]]:
    """A function that shows what to do: redrawn on a terminal, else a line whenever something changes."""
    parts = (AIM_TURN, TURN) if turn_only else (AIM_TURN, TURN, AIM_DRIVE, DRIVE)
    todo = {part: _TODO[part].format(way="backwards, away from" if backwards else "towards") for part in parts}
    with live_screen("opening the camera", lambda state: drawn(state, todo, width_px), _line_by_line(todo)) as show:
        yield show


def drawn(state: LiveState, todo: dict[str, str], width_px: int) -> Group:
    """The step, its instruction, where the tags are, how far it has come, and why Enter did not go on."""
    number = list(todo).index(state.part) + 1
    step = Panel(Text(todo[state.part]), title=f"{number} of {len(todo)}: {state.part}", title_align="left")
    lines = [Text(f"|{_where(state, width_px)}|  {_seen(state)}"), Text(_done(state))]
    if state.refused:
        lines.append(Text(f"not yet: {state.refused}", style="yellow"))
    return Group(step, *lines, Text("Ctrl-C gives up", style="dim"))


def _line_by_line(todo: dict[str, str]) -> Callable[[LiveState], None]:
    part, shown = "", 0

    def show(state: LiveState) -> None:
        nonlocal part, shown
        if state.part != part:
            part = state.part
            tell(f"{list(todo).index(part) + 1} of {len(todo)}: {todo[part]}")
        if state.refused:
            tell(f"not yet: {state.refused}")
        if sum(state.pictures) >= shown + _EVERY_PICTURES:
            shown = sum(state.pictures)
            tell(f"{_seen(state)}; {_done(state)}")

    return show


def _where(state: LiveState, width_px: int) -> str:
    """The picture from left to right, a mark where a tag's centre is."""
    cells = [" "] * _SCALE
    for centre in state.tags.values():
        cells[min(max(int(centre[0] / width_px * _SCALE), 0), _SCALE - 1)] = "#"
    return "".join(cells)


def _seen(state: LiveState) -> str:
    if not state.tags:
        return "no tag in the picture"
    ids = ", ".join(map(str, sorted(state.tags)))
    return f"tag{'s' if len(state.tags) > 1 else ''} {ids} in the picture"


def _done(state: LiveState) -> str:
    turned = f"turned by about {math.degrees(state.turned_rad):.0f} of {math.degrees(SMALL_TURN_RAD):.0f}° or more"
    said = f"{turned} ({state.pictures[0]} pictures)"
    if state.part in (AIM_DRIVE, DRIVE):
        said += f"; driven about {state.driven_m:.2f} of {SMALL_DRIVE_M:g} m or more ({state.pictures[1]} pictures)"
    return said
