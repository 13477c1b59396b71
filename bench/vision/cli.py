"""The command line of `scripts/bench vision`."""

from __future__ import annotations

import json
import os
import platform
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from bench.vision.baselines import Wheels
from bench.vision.charts import save_charts
from bench.vision.compiled import load_compiled
from bench.vision.conditions import CONDITIONS, Condition
from bench.vision.goals import Goal
from bench.vision.parts import PARTS, QUICK, Effort, Outcome, Task
from bench.vision.tables import goals_table
from bench.vision.trackers import Cast
from pilotfish.cli.console import console, friendly_errors, progress

app = typer.Typer(
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_show_locals=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
PartName = Enum("PartName", {name: name for name in PARTS}, type=str)


@app.command()
def main(
    quick: Annotated[bool, typer.Option("--quick", help="A few frames of everything: does it run?")] = False,
    part: Annotated[
        list[PartName] | None, typer.Option(help="Only this part; may be given several times. Default: all.")
    ] = None,
    condition: Annotated[
        list[str] | None, typer.Option(help="Only this condition of the part `chains`; may be given several times.")
    ] = None,
    frames: Annotated[
        int | None,
        typer.Option(min=8, help="Frames of each condition and distance of the part `chains` [default: 32]."),
    ] = None,
    frames_without_leader: Annotated[
        int | None, typer.Option(min=20, help="Frames without the leader, in which a detection is false.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of every frame. Same seed: same frames.")] = 1,
    out: Annotated[Path, typer.Option(help="Where vision.json and the pictures go.")] = Path("out/bench"),
) -> None:
    """Pilotfish's tracker beside its baselines: the same frames, same run, ten at a time in turns, one thread each.

    Baselines: ViSP and libapriltag (Debian), the newest AprilTag and OpenCV's ArUco (PyPI). The compiled ones are built
    into build/bench when they are missing. Prints what every tracker made of every sequence, then one row a goal.

    \b
    Examples
      scripts/bench vision                               everything, 10 to 20 minutes
      scripts/bench vision -- --quick                    a few frames of everything
      scripts/bench vision -- --part drive --part lens   these alone
      scripts/bench vision -- --part chains --condition 'rolling shutter' --frames 300
      scripts/bench vision -- --part without-leader --frames-without-leader 100000
    """
    effort = QUICK if quick else Effort()
    if frames is not None:
        effort = replace(effort, chains=frames)
    if frames_without_leader is not None:
        effort = replace(effort, without_leader=frames_without_leader)
    conditions = _conditions(condition)
    names = [chosen.value for chosen in part] if part else list(PARTS)
    with friendly_errors():
        compiled = load_compiled(console.print)
        with Wheels() as wheels:
            timed = _run_parts(names, Cast(compiled, wheels), effort, seed, conditions)
    outcomes = {name: outcome for name, (outcome, _) in timed.items()}
    for outcome in outcomes.values():
        for table in outcome.tables:
            console.print(table)
    goals = [goal for outcome in outcomes.values() for goal in outcome.goals]
    if goals:
        console.print(goals_table(goals))
    result = {
        "seed": seed,
        "machine": {"processor": _processor(), "cores": os.cpu_count(), "system": platform.platform()},
        "versions": wheels.versions,
        "goals": [_goal_as_json(goal) for goal in goals],
    }
    result |= {name: {"took_s": took_s, "figures": outcome.data} for name, (outcome, took_s) in timed.items()}
    out.mkdir(parents=True, exist_ok=True)
    file = out / "vision.json"
    file.write_text(json.dumps(result, indent=1, allow_nan=False) + "\n")
    cells = outcomes["accuracy"].cells if "accuracy" in outcomes else None
    by_size = outcomes["resolutions"].by_size if "resolutions" in outcomes else None
    for written in [file, *save_charts(out, cells, by_size)]:
        console.print(f"wrote {written}", soft_wrap=True)


def _conditions(names: list[str] | None) -> tuple[Condition, ...]:
    if not names:
        return CONDITIONS
    known = {each.name: each for each in CONDITIONS}
    for name in names:
        if name not in known:
            raise typer.BadParameter(f"no condition '{name}'; there are: {', '.join(known)}")
    return tuple(known[name] for name in names)


def _run_parts(
    names: list[str], cast: Cast, effort: Effort, seed: int, conditions: tuple[Condition, ...]
) -> dict[str, tuple[Outcome, float]]:
    """What came of each part, and how long it took [s]."""
    outcomes = {}
    for name in names:
        part, start = PARTS[name], time.monotonic()
        with _counting(part.label, part.frames(effort, conditions)) as on_frame:
            outcome = part.run(Task(cast, effort, seed, on_frame, conditions))
        outcomes[name] = (outcome, round(time.monotonic() - start, 1))
    return outcomes


@contextmanager
def _counting(label: str, total: int) -> Iterator[Callable[[], None]]:
    with progress(label) as step:
        done = 0

        def on_frame() -> None:
            nonlocal done
            done += 1
            step(done, total)

        yield on_frame


def _processor() -> str:
    """As /proc/cpuinfo calls it; times mean nothing without it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def _goal_as_json(goal: Goal) -> dict:
    known = goal.ratio == goal.ratio  # NaN differs from itself, and JSON has none
    return vars(goal) | {"ratio": goal.ratio if known else None}
