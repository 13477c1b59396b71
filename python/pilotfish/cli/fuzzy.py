"""``pilotfish fuzzy``: look at a fuzzy controller, check it, draw it, ask it why, and convert it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import console, friendly_errors, warn
from pilotfish.cli.fuzzy_prove import prove
from pilotfish.cli.options import between
from pilotfish.cli.outputs import output_file, output_folder, output_picture, writable_folder
from pilotfish.errors import ConfigError

if TYPE_CHECKING:
    from pilotfish import fuzzy
    from pilotfish.fuzzy_report import Report

app = typer.Typer(
    help="Look at a fuzzy controller (our .yaml or fuzzylite's .fll): show, check, prove, plot, explain, convert.",
    no_args_is_help=True,
)

FileArgument = Annotated[
    Path, typer.Argument(exists=True, dir_okay=False, help="Fuzzy sets and rules: our .yaml, or fuzzylite's .fll.")
]
FINDINGS = 1  # exit code of check


_INPUT = between(-1e9, 1e9)  # universes are of the order of one; outside, an input saturates
_WIDTH = between(0.0, 1e9)


@app.command()
def show(file: FileArgument) -> None:
    """Print the sets, the rules, and what comes of them.

    \b
    Example
      pilotfish fuzzy show data/fuzzy/coordination.yaml
    """
    from pilotfish.cli.fuzzy_tables import figures_table, rules_table, sets_table
    from pilotfish.fuzzy_report import analyse, load

    with friendly_errors():
        controller = load(file)
        for variable in (controller.error, controller.error_change, controller.output):
            console.print(sets_table(variable))
        console.print(rules_table(controller))
        report = analyse(controller)
        console.print(figures_table(report))
        _print_findings(report)


@app.command()
def check(file: FileArgument) -> None:
    """Validate the file and look for dead zones, jumps and rules that never fire; exit code 78 if it cannot be used, 1
    if something is found.

    \b
    Example
      pilotfish fuzzy check data/fuzzy/coordination.yaml
    """
    from pilotfish.fuzzy_report import analyse, load

    with friendly_errors():
        controller = load(file)
        report = analyse(controller)
        _print_findings(report)
        if report.findings:
            raise typer.Exit(FINDINGS)


app.command()(prove)


@app.command()
def plot(
    file: FileArgument,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", file_okay=False, callback=writable_folder, help="Folder for the pictures; default: beside FILE."
        ),
    ] = None,
) -> None:
    """Draw the sets, the surface u(e, ec) and the curve u(e, 0) as PNG files.

    \b
    Example
      pilotfish fuzzy plot data/fuzzy/coordination.yaml --out out
    """
    from pilotfish.fuzzy_report import analyse, load
    from pilotfish.plots.fuzzy_curve import draw_curve
    from pilotfish.plots.fuzzy_sets import draw_fuzzy_sets
    from pilotfish.plots.style import save
    from pilotfish.plots.surface import draw_surface

    with friendly_errors():
        controller = load(file)
        name, folder = controller.name, out or file.parent
        into = output_folder(folder)
        drawings = {
            "sets": draw_fuzzy_sets(controller, f"Membership functions of '{name}'"),
            "surface": draw_surface(controller, f"Control surface of '{name}'"),
            "curve": draw_curve(controller, analyse(controller), f"The curve u(e, 0) of '{name}'"),
        }
        for kind, figure in drawings.items():
            into.wrote(save(figure, folder / f"{file.stem}_{kind}.png"))


@app.command()
def explain(
    file: FileArgument,
    error: Annotated[float, typer.Option("--e", callback=_INPUT, help="The error, on its universe.")],
    error_change: Annotated[float, typer.Option("--ec", callback=_INPUT, help="Its change, on its universe.")] = 0.0,
    width_error: Annotated[
        float, typer.Option(callback=_WIDTH, help="Width of the input A' of eq. (6); 0: singleton.")
    ] = 0.0,
    width_error_change: Annotated[float, typer.Option(callback=_WIDTH, help="Width of B'.")] = 0.0,
    out: Annotated[
        Path | None, typer.Option("--out", dir_okay=False, help="Draw it, into this file: .png, .svg or .pdf.")
    ] = None,
) -> None:
    """Say which rules fire at one pair of inputs, how strongly, and what comes of them.

    \b
    Examples
      pilotfish fuzzy explain data/fuzzy/coordination.yaml --e -0.2 --ec 0.1
      pilotfish fuzzy explain data/fuzzy/coordination.yaml --e -0.2 --out out/why.png
    """
    from pilotfish import fuzzy
    from pilotfish.cli.fuzzy_tables import firing_table
    from pilotfish.fuzzy_report import load
    from pilotfish.plots.fuzzy_explanation import draw_explanation
    from pilotfish.plots.style import save

    with friendly_errors():
        picture = output_picture(out) if out else None
        controller = load(file)
        widths = fuzzy.InputWidths(error=width_error, error_change=width_error_change)
        for variable, value in ((controller.error, error), (controller.error_change, error_change)):
            if not variable.min <= value <= variable.max:
                nearest = min(max(value, variable.min), variable.max)
                warn(f"{variable.name} = {value:g} is beyond its universe and counts as {nearest:g}")
        console.print(firing_table(controller, fuzzy.explain(controller, error, error_change, widths)))
        if picture:
            save(draw_explanation(controller, error, error_change, widths), picture.file)
            picture.wrote()


@app.command()
def convert(
    source: FileArgument,
    target: Annotated[Path, typer.Argument(dir_okay=False, help="Where to; the ending says the form: .yaml or .fll.")],
) -> None:
    """Write a controller in the other language, with every digit.

    \b
    Examples
      pilotfish fuzzy convert data/fuzzy/coordination.yaml coordination.fll
      pilotfish fuzzy convert coordination.fll coordination.yaml
    """
    from pilotfish.fuzzy_report import load
    from pilotfish.whole_files import write_whole

    with friendly_errors():
        output = output_file(target, [source])
        write_whole(target, _written(load(source), target))
        output.wrote()


def _written(controller: fuzzy.Controller, target: Path) -> str:
    from pilotfish import fuzzy

    write = {".fll": fuzzy.to_fll, ".yaml": fuzzy.to_yaml, ".yml": fuzzy.to_yaml}.get(target.suffix)
    if write is None:
        raise typer.BadParameter(f"'{target.suffix}' is neither .yaml nor .fll", param_hint="TARGET")
    try:
        return write(controller)
    except ValueError as error:
        raise ConfigError(str(error)) from error


def _print_findings(report: Report) -> None:
    for finding in report.findings:
        console.print(f"[bold yellow]found[/] {finding}", soft_wrap=True)
    if not report.findings:
        console.print("no dead zone, no discontinuity, and every rule fires somewhere")
    for rule in report.never_decides:
        console.print(f"[dim]note: another rule is always at least as strong as  {rule}[/]", soft_wrap=True)
