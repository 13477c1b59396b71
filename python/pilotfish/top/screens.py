"""The help of ``pilotfish top``, above everything until a key is pressed."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

from pilotfish.watching.columns import COLUMNS

_KEYS = """\
[b]Keys[/b]
  up, down    select a robot; below are its last events
  s           stop the selected robot, at once and without a question (as pilotfish stop)
  < >         sort by the column to the left, to the right; or click its title
  R           reverse the order
  ?           this help          q   end

A stop is latched. It is ended on purpose elsewhere: pilotfish resume ROBOT.

[b]Columns[/b]
"""


def help_text() -> str:
    """Keys and columns, in Textual's markup."""
    titles = (column.title.replace("[", r"\[") for column in COLUMNS)
    width = max(len(column.title) for column in COLUMNS)
    lines = [
        f"  {title}{' ' * (width - len(column.title))}  {column.help}"
        for title, column in zip(titles, COLUMNS, strict=True)
    ]
    return _KEYS + "\n".join(lines)


class HelpScreen(ModalScreen[None]):
    """Any of the keys named closes it."""

    BINDINGS: ClassVar = [
        ("escape,question_mark,q,enter,space", "dismiss", "Close"),
    ]
    CSS = """
    HelpScreen { align: center middle; }
    HelpScreen VerticalScroll { width: 92%; max-width: 100; height: auto; max-height: 92%; border: round $accent;
                                background: $surface; padding: 0 1; }
    """

    def compose(self) -> ComposeResult:
        """One text, which scrolls on a small terminal."""
        with VerticalScroll():
            yield Static(help_text())

    def action_dismiss(self, result: None = None) -> None:  # type: ignore[override]
        """Back to the robots."""
        self.dismiss(result)
