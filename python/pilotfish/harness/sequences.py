"""Sequences of pictures on disk: rendered into a folder, and looked at by the coordinator program.

A folder holds ``000000.png``, ... and ``frames.csv``, whose first two columns (file, utime_us) are what
``pilotfish-coordinator --source images:DIR`` reads; the others are the truth, to check what it
says.
"""

from __future__ import annotations

import csv
import tempfile
from pathlib import Path

from PIL import Image

from pilotfish import capture
from pilotfish.errors import HarnessError
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.harness.frame_report import FrameReport, parse_reports
from pilotfish.harness.in_process import FrameEvent, run_in_process
from pilotfish.harness.run import OnProgress
from pilotfish.harness.scenario import Scenario
from pilotfish.whole_files import written_whole

FRAMES_FILE = "frames.csv"
TRUTH_COLUMNS = ("true_distance_m", "true_bearing_rad", "true_heading_rad")
_SECONDS_PER_PICTURE = 1.0  # a bound for slow machines
_START_WITHIN_S = 20.0


def render_sequence(
    scenario: Scenario,
    out: Path,
    *,
    frames: int | None = None,
    robot: str | None = None,
    profile: str = "anticipate",
    on_progress: OnProgress | None = None,
) -> int:
    """Writes what ``robot``'s camera sees while its coordinator drives it; the number of pictures written."""
    name = scenario.robot(robot).name
    rows: list[tuple[str, int, float, float, float]] = []

    def write(event: FrameEvent) -> None:
        if event.robot == name and event.frame is not None:
            file = f"{event.index:06d}.png"
            with written_whole(out / file) as partial:
                Image.fromarray(event.frame.image).save(partial, "PNG")
            rows.append((file, event.frame.utime, *event.world.true_relative_pose(name)))

    duration_s = frames / scenario.frame_rate_hz if frames else scenario.duration_s
    run_in_process(scenario, profile=profile, duration_s=duration_s, on_progress=on_progress, on_frame=write)
    with written_whole(out / FRAMES_FILE) as partial, partial.open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["file", "utime_us", *TRUTH_COLUMNS])
        writer.writerows(rows)
    return len(rows)


def look_at_images(folder: Path, config: Path, *, profile: str | None = None) -> list[FrameReport]:
    """What ``pilotfish-coordinator --source images:folder`` says about each picture, in order."""
    pictures = sum(1 for file in folder.iterdir() if file.suffix.lower() in capture.PICTURE_SUFFIXES)
    if not pictures:
        raise HarnessError(f"no pictures in {folder}")
    command: list[str | Path] = [
        find_executable(COORDINATOR),
        "--config",
        config,
        "--source",
        f"images:{folder}",
    ]
    command += ["--lcm-url", "memq://", "--json", *(["--profile", profile] if profile else [])]
    with (
        tempfile.TemporaryDirectory(prefix="pilotfish-") as temporary,
        Child(command, Path(temporary), "coordinator") as child,
    ):
        code = child.wait(_START_WITHIN_S + _SECONDS_PER_PICTURE * pictures)
        if code is None:
            raise child.error(f"did not look at {pictures} pictures in time")
        if code:
            raise child.error(f"ended with {code}")
        return parse_reports(child.stdout().splitlines())
