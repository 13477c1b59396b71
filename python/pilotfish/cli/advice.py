"""What was found, and what to do about it: on a terminal in columns, in a pipe or a file a line each."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

_WIDTH = 80
_GAP = 2
Column = tuple[str, int, str]  # text, width, style


def print_finding(console: Console, columns: Sequence[Column], seen: str, advice: str = "") -> None:
    """``seen`` is wrapped on a terminal alone. ``advice`` never is, because there are commands in it: a terminal that
    folds a long line copies it as one."""
    if console.is_terminal:
        table = Table.grid(padding=(0, _GAP, 0, 0))
        for _, width, _ in columns:
            table.add_column(width=width, overflow="fold")
        table.add_column(overflow="fold")
        table.add_row(*(Text(text, style=style) for text, _, style in columns), Text(seen))
        console.print(table, width=min(_WIDTH, console.width))
    else:
        line = "".join(f"{text:<{width + _GAP}}" for text, width, _ in columns) + seen
        console.print(Text(line), soft_wrap=True, highlight=False)
    if advice:
        indent = " " * (columns[0][1] + _GAP)
        console.print(Text(f"{indent}-> {advice}", style="italic"), soft_wrap=True, highlight=False)
