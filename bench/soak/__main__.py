"""A day of robot time with a fault every ten seconds.

Takes: half an hour; hours if the computer is busy.
scripts/bench soak                                   24 h of robot time
scripts/bench soak -- --hours 0.2 --rate-hz 30       twelve minutes of it
scripts/bench soak -- --hours 0.05 --fault gray --fault second-coordinator
"""

from __future__ import annotations

import json
import os
import platform
import signal
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import pictures
import typer
from chart import draw
from fault_kinds import FAULTS
from goals import goals, recoveries
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from robot import Robot
from run import Soak, soak

from bench.common.statistics import quantile

console = Console(width=120)
_HOUR_S = 3600.0


def main(
    hours: Annotated[float, typer.Option(min=0.005, help="Of robot time.")] = 24.0,
    seed: Annotated[int, typer.Option(min=0, help="Of the faults: which, when, how long.")] = 1,
    rate_hz: Annotated[
        float,
        typer.Option(min=12.0, max=60.0, help="The camera's. 12 is the slowest to which the 100 ms rule applies."),
    ] = 12.0,
    fault: Annotated[list[str] | None, typer.Option(help=f"Only this one of {', '.join(FAULTS)}.")] = None,
    out: Annotated[Path, typer.Option(help="Folder for soak.json and soak.png.")] = Path("out"),
) -> None:
    """A real pilotfish-coordinator and a real pilotfish-base drive behind a rendered leader, and every 10 s of robot
    time something goes wrong for up to 4 s. Does memory grow, do descriptors or threads leak, does anything move that
    must not, and how long does it take to drive again?

    Pictures are shown as fast as they are answered, so a robot hour takes a minute or two. Ends with 1 if a goal is
    missed. soak.json is written every robot hour: what has been found until then survives an interruption.

    \b
    What the columns say
      stood      how many of them stopped the robot while they lasted
      recovery   from the first good picture after the fault until the robot tracks and moves, robot time
      wheels     until pilotfish-base drives, too, wall time: it lives in that
    """
    if wrong := set(fault or ()) - set(FAULTS):
        raise typer.BadParameter(f"{', '.join(sorted(wrong))}: there is {', '.join(FAULTS)}")
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # hours are long: whoever ends this ends its robot, too
    kinds = [kind for kind in FAULTS if kind in (fault or FAULTS)]
    out.mkdir(parents=True, exist_ok=True)
    shown = pictures.render(rate_hz)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with (
        tempfile.TemporaryDirectory() as folder,
        Robot(Path(folder), rate_hz, shown) as robot,
        Progress(*columns, console=Console(stderr=True)) as bar,
    ):
        task = bar.add_task("soak", total=hours * _HOUR_S)
        written_h = 0

        def progress(found: Soak) -> None:
            nonlocal written_h
            times = found.robot_s / max(found.wall_s, 1e-9)
            label = f"{found.robot_s / _HOUR_S:.2f} h, {len(found.played)} faults, {times:.0f} x real time"
            bar.update(task, completed=found.robot_s, description=label)
            if found.robot_s >= (written_h + 1) * _HOUR_S:
                written_h = int(found.robot_s / _HOUR_S)
                _write(found, out, seed)
                if not bar.console.is_terminal:
                    bar.console.print(label)

        found = soak(robot, hours * _HOUR_S, seed, kinds, progress)
    _write(found, out, seed)
    console.print(_fault_table(found), _goal_table(found))
    for violation in found.violations[:20]:
        console.print(f"[red]{violation}[/]")
    console.print(f"wrote {out / 'soak.json'} and {draw(found, out / 'soak.png')}", soft_wrap=True)
    raise typer.Exit(any(goal.met is False for goal in goals(found)))


def _write(found: Soak, out: Path, seed: int) -> None:
    machine = {"machine": platform.processor() or platform.machine(), "cores": os.cpu_count()}
    report = machine | {"seed": seed} | asdict(found) | {"goals": [asdict(goal) for goal in goals(found)]}
    (out / "soak.json").write_text(json.dumps(report, indent=1) + "\n")


def _fault_table(found: Soak) -> Table:
    table = Table(title="Recovery from each fault [s]", title_justify="left")
    for column in ("what happens", "times", "stood", "p50", "p99", "max", "wheels, max"):
        table.add_column(column, justify="left" if column == "what happens" else "right")
    for kind, values in recoveries(found).items():
        at = [quantile(values, share) for share in (0.5, 0.99, 1.0)]
        those = [played for played in found.played if played.kind == kind and not played.disturbed]
        wheels_s, stood = max(played.wheels_s for played in those), sum(played.stood for played in those)
        times = f"{len(values)}", f"{stood}", *(f"{value:.3f}" for value in (*at, wheels_s))
        table.add_row(FAULTS[kind].words, *times)
    return table


def _goal_table(found: Soak) -> Table:
    times = found.robot_s / found.wall_s
    title = f"{found.robot_s / _HOUR_S:.2f} h of robot time at {found.rate_hz:g} Hz, {len(found.played)} faults"
    caption = (
        f"{found.frames} pictures, {times:.0f} times faster than real time; {found.resent} were sent again, and "
        f"{len(found.stumbles)} good ones behind a recovery had no answer that moves.\n"
        f"{sum(played.disturbed for played in found.played)} faults not counted: this script did not run meanwhile"
    )
    table = Table(title=title, caption=caption, title_justify="left", caption_justify="left")
    for column in ("what", "goal", "found", "met"):
        table.add_column(column)
    for goal in goals(found):
        met = "-" if goal.met is None else "[green]yes[/]" if goal.met else "[red]no[/]"
        table.add_row(goal.words, goal.goal, goal.found, met)
    return table


if __name__ == "__main__":
    typer.run(main)
