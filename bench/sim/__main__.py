"""The simulator in a closed loop, beside ViSP's; and with 1 to 100 robots.

Takes: 6 minutes; 20 s with --quick.
scripts/bench sim
scripts/bench sim -- --quick
scripts/bench sim -- --part follow --seconds 10
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import typer
from rich.console import Console

from bench.common.compiled import RELEASE, built
from bench.sim import tables
from bench.sim.charts import draw_scale
from bench.sim.figures import CrowdFigures, crowd_figures, exponent, loop_figures, ratios
from bench.sim.programs import play_programs
from bench.sim.scenarios import CONDITIONS, column, following
from pilotfish import sim
from pilotfish.errors import PilotfishError
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.scenario import Scenario
from pilotfish.plots.style import LIGHT, save

console = Console(width=140)
CROWD = 20
ROBOTS = (1, 2, 5, 10, 20, 50, 100)
Sim = Callable[..., list[dict[str, Any]]]


def main(
    quick: Annotated[bool, typer.Option("--quick", help="A second of everything: a look, not a result.")] = False,
    part: Annotated[list[str] | None, typer.Option(help="Only this one of follow, crowd, programs, scale.")] = None,
    seconds: Annotated[float, typer.Option(min=1.0, max=600.0, help="Of robot time, of each closed loop.")] = 20.0,
    build: Annotated[Path, typer.Option(help="The build tree.")] = RELEASE,
    out: Annotated[Path, typer.Option(help="Folder for sim.json and sim_scale.png.")] = Path("out/bench"),
) -> None:
    """How many closed-loop frames a second, how many robots in real time, and how the cost grows with the robots.

    \b
    follow     one robot behind a leader: our pictures and our coordinator, and vpImageSimulator with
               vpDetectorAprilTag, with the same robots, controller, camera and tags, in turns, under three cameras
    crowd      20 robots in one process, on one thread and on two
    programs   20 real pilotfish-coordinator processes and one pilotfish-sim --realtime on one bus
    scale      1 to 100 robots in a column: processor time per robot, and the exponent of its growth
    """
    parts = {"follow": _follow, "crowd": _crowd, "programs": _programs, "scale": _scale}
    if wrong := set(part or ()) - set(parts):
        raise typer.BadParameter(f"--part: {', '.join(sorted(wrong))}: there is {', '.join(parts)}")
    program = built("sim/sim_benchmark", build)
    environment = os.environ | {"OMP_NUM_THREADS": "1"}

    def played(what: str, *arguments: object) -> list[dict[str, Any]]:
        command = [str(word) for word in (program, what, *arguments)]
        done = subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE, env=environment)
        return [json.loads(line) for line in done.stdout.splitlines()]

    result: dict[str, Any] = {"machine": platform.platform(), "cores": os.cpu_count(), "quick": quick}
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="pilotfish-") as folder:
        for name in part or parts:
            load = f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} processors"
            console.print(f"load of the computer before {name}: {load}")
            result[name] = parts[name](played, Path(folder), 1.0 if quick else seconds, quick, out)
    (out / "sim.json").write_text(json.dumps(result, indent=1) + "\n")
    console.print(f"wrote {out / 'sim.json'}", soft_wrap=True)


def _follow(played: Sim, folder: Path, seconds: float, quick: bool, out: Path) -> dict[str, Any]:
    result = {}
    for condition, change in CONDITIONS.items():
        file = following(condition, folder / condition)
        rows = loop_figures(played("follow", file, round(30 * seconds)))
        harness_per_s = _harness(file, seconds)
        console.print(tables.loops(f"{condition}: {change['says']}", rows, ratios(rows), harness_per_s))
        result[condition] = {"loops": [asdict(row) for row in rows], "ratios": ratios(rows)}
        result[condition]["python_harness_frames_per_s"] = harness_per_s
    return result


def _harness(file: Path, seconds: float) -> float:
    """Frames per second of processor time of the same run with pilotfish.harness, in Python."""
    scenario, spec = Scenario.load(file), sim.load_scenario(file)
    begin = time.process_time()
    run_in_process(scenario, profile="anticipate", spec=spec, duration_s=0.1)
    made = time.process_time()
    run_in_process(scenario, profile="anticipate", spec=spec, duration_s=0.1 + seconds)
    return 30 * seconds / ((time.process_time() - made) - (made - begin))


def _crowd(played: Sim, folder: Path, seconds: float, quick: bool, out: Path) -> list[dict[str, Any]]:
    rows = _crowds(played, folder, CROWD, (1, 2), round(30 * min(seconds, 5.0)))
    console.print(tables.crowds(f"{CROWD} robots at 30 Hz in one process", rows))
    if len({row.pictures for row in rows}) > 1:
        raise SystemExit("the pictures are not the same on one thread and on two")
    return [asdict(row) for row in rows]


def _programs(played: Sim, folder: Path, seconds: float, quick: bool, out: Path) -> list[dict[str, Any]]:
    rows = []
    for robots in (2,) if quick else (1, 5, CROWD):
        try:
            rows.append(play_programs(column(robots, folder / f"column{robots}"), min(seconds, 10.0)))
        except PilotfishError as error:
            raise SystemExit(str(error)) from error
    console.print(tables.programs(rows))
    return [asdict(row) for row in rows]


def _scale(played: Sim, folder: Path, seconds: float, quick: bool, out: Path) -> dict[str, Any]:
    rows = []
    for robots in (1, 2, 5) if quick else ROBOTS:
        # As many frames each: the first, in which the leader is searched for, counts as much for all.
        rows += _crowds(played, folder, robots, (1,), 15 if quick else 30)
    counts = [row.robots for row in rows]
    grows = exponent(counts, [row.robots * row.robot_frame_ms for row in rows])
    console.print(tables.crowds(f"a column: the cost of a frame grows as robots^{grows:.2f}", rows))
    console.print(f"wrote {save(draw_scale(rows, grows, LIGHT), out / 'sim_scale.png')}", soft_wrap=True)
    return {"exponent": grows, "rows": [asdict(row) for row in rows]}


def _crowds(played: Sim, folder: Path, robots: int, threads: tuple[int, ...], frames: int) -> list[CrowdFigures]:
    file = column(robots, folder / f"column{robots}")
    return [crowd_figures(played("crowd", file, frames, count)[0]) for count in threads]


if __name__ == "__main__":
    typer.run(main)
