"""What a rehearsed calibration found beside the truth, on the console."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from pilotfish.cli.console import console, tell

if TYPE_CHECKING:
    from pilotfish.calibration.rehearsal import Difference

OFF_TRUTH = 1  # exit code: a check has findings


def truth_option(whose: str) -> typer.models.OptionInfo:
    """``--truth``, of a rehearsal with rendered pictures."""
    return typer.Option(
        "--truth",
        exists=True,
        dir_okay=False,
        help=f"Compare with {whose}; exit code 1 if it is off by more than is allowed.",
    )


def print_differences(differences: Sequence[Difference], truth: Path) -> bool:
    """A table, and a line that says whether all agree; that."""
    table = Table(title="beside the truth", box=SIMPLE_HEAD)
    for column in ("", "found", "true", "off", "allowed"):
        table.add_column(column, justify="right")
    for each in differences:
        found, true = (f"{v + 0.0:.3f} {each.unit}" if v is not None else "" for v in (each.found, each.true))
        allowed = "" if each.allowed is None else f"{each.allowed:g} {each.off_unit}"
        sign = "+" if each.found is not None else ""
        off = f"{each.off + 0.0:{sign}.{_digits(each.off_unit)}f} {each.off_unit}"
        table.add_row(each.name, found, true, Text(off, "" if each.agrees else "bold red"), allowed)
    console.print(table)
    wrong = [each for each in differences if not each.agrees]
    if not wrong:
        tell(f"agrees with {truth}")
        return True
    said = ", ".join(f"{each.name} by {abs(each.off):.3g} {each.off_unit} ({each.allowed:g} allowed)" for each in wrong)
    tell(f"differs from {truth}: {said}")
    return False


def _digits(unit: str) -> int:
    return 4 if unit == "%" else 3


TruthOfCamera = Annotated[Path | None, truth_option("a calibration: the truth.yaml of `pilotfish render board`")]
TruthOfMounting = Annotated[
    Path | None, truth_option("a file with `camera: mounting:`: the truth.yaml of `pilotfish render mounting`")
]
TruthOfBody = Annotated[Path | None, truth_option("a leader's file: the truth.yaml of `pilotfish render body`")]
