"""``pilotfish render``: what a robot's camera sees in a scenario, and what a calibration needs to be shown."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.completing import shipped_scenarios
from pilotfish.cli.console import friendly_errors, progress, tell
from pilotfish.cli.default_command import DefaultCommandGroup
from pilotfish.cli.driving_options import Profile, ProfileOption
from pilotfish.cli.outputs import writable_folder
from pilotfish.cli.render_board import board
from pilotfish.cli.render_body import body
from pilotfish.cli.render_mounting import mounting


class _ScenarioByDefault(DefaultCommandGroup):
    default = "scenario"


app = typer.Typer(
    cls=_ScenarioByDefault,
    no_args_is_help=True,
    help="""Render pictures: of a scenario, or to rehearse a calibration before there is a camera.

\b
Examples
  pilotfish render line --out out/line --frames 60
  pilotfish render board --out out/board
  pilotfish render mounting --out out/run.lcmlog
  pilotfish render body --out out/body

`pilotfish render SCENARIO` is `pilotfish render scenario SCENARIO`; its options: `pilotfish render scenario --help`.
""",
)


@app.command()
def scenario(
    scenario: Annotated[
        str,
        typer.Argument(
            help="A scenario file, or the name of a shipped one (line, circle, ...).", autocompletion=shipped_scenarios
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "--out", file_okay=False, callback=writable_folder, help="Folder for the pictures and frames.csv."
        ),
    ],
    frames: Annotated[
        int | None, typer.Option(min=1, max=1_000_000, help="How many; default: the whole scenario.")
    ] = None,
    robot: Annotated[str | None, typer.Option(help="Whose camera; default: the first follower's.")] = None,
    profile: ProfileOption = Profile.anticipate,
) -> None:
    """Render what a robot's camera sees while its coordinator drives it: PNGs and frames.csv with the true
    poses.

    \b
    Example: render, then let the coordinator look at the pictures
      pilotfish render scenario line --out out/line --frames 60
      pilotfish-coordinator --config data/config/line.yaml \\
          --source images:out/line --lcm-url memq:// --json
    """
    from pilotfish.harness.scenario import Scenario
    from pilotfish.harness.sequences import FRAMES_FILE, render_sequence

    with friendly_errors():
        loaded = Scenario.load(_scenario_file(scenario))
        again = (out / FRAMES_FILE).exists()
        with progress(f"rendering {loaded.name}") as step:
            written = render_sequence(loaded, out, frames=frames, robot=robot, profile=profile.value, on_progress=step)
        tell(f"wrote {written} pictures and {FRAMES_FILE} to {out}{' (replaced)' if again else ''}")


for command in (board, mounting, body):
    app.command()(command)


def _scenario_file(name: str) -> Path:
    from pilotfish import data

    return Path(name) if Path(name).is_file() or "/" in name else data.scenario(name)
