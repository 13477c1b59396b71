"""Runs a scenario with the real programs: one simulator, one coordinator per robot, LCM between them, in
lock-step.

In lock-step the simulator waits for the command that answers each picture, so a run depends on nothing but
the scenario and may be faster than real time.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from pilotfish.harness.child import Child
from pilotfish.harness.driving import Driving
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.harness.frame_report import parse_reports
from pilotfish.harness.ports import private_lcm_url
from pilotfish.harness.run import OnProgress, Run, measured
from pilotfish.harness.scenario import Scenario
from pilotfish.recording import read_csv

READY_WITHIN_S = 20.0
# A picture takes some 30 ms to render, send, look at and answer; this is a bound for slow machines, not a
# forecast.
SECONDS_PER_FRAME = 0.5


def run_over_lcm(
    scenario: Scenario,
    *,
    profile: str,
    tuning: Path | None = None,
    duration_s: float | None = None,
    lcm_url: str | None = None,
    coordinator_options: Sequence[str] = (),
    sim_options: Sequence[str] = (),
    on_progress: OnProgress | None = None,
) -> Run:
    """Plays the scenario on a bus of its own. Raises HarnessError with what the failing program said. The options are
    given to every coordinator and to the simulator."""
    url = lcm_url or private_lcm_url()
    driving = Driving(profile, tuning)
    seconds = duration_s or scenario.duration_s
    frames = scenario.frame_count(seconds)
    sim_program, coordinator_program = find_executable(SIM), find_executable(COORDINATOR)
    with tempfile.TemporaryDirectory(prefix="pilotfish-") as temporary, ExitStack() as children:
        folder = Path(temporary)
        coordinators: dict[str, Child] = {}
        for robot in scenario.robots:
            command = [coordinator_program, "--config", robot.coordinator_file, "--name", robot.name]
            command += ["--source", "lcm", "--lcm-url", url, *driving.options(), *coordinator_options]
            command += ["--simulated-time", "--json"]
            coordinators[robot.name] = children.enter_context(Child(command, folder, robot.name))
        for child in coordinators.values():
            child.wait_until(lambda child=child: _is_ready(child), READY_WITHIN_S, "being ready")

        record_file = folder / "record.csv"
        command = [sim_program, "--scenario", scenario.file, "--lcm-url", url, "--lockstep"]
        command += ["--record", record_file, "--duration-s", str(seconds), *sim_options]
        sim = children.enter_context(Child(command, folder, "sim"))
        _wait_for_end(sim, coordinators, frames, on_progress)

        for child in coordinators.values():
            if code := child.terminate():
                raise child.error(f"ended with {code}")
        reports = {name: parse_reports(child.stdout().splitlines()) for name, child in coordinators.items()}
        recordings = {
            name: scenario.annotate(recording, profile, "lcm").with_measurements(measured(reports[name]))
            for name, recording in read_csv(record_file).items()
        }
    return Run(recordings, reports)


def _is_ready(child: Child) -> bool:
    """The coordinator has said what it uses, which it does after it has subscribed."""
    return " ready: " in child.stderr()


def _wait_for_end(sim: Child, coordinators: dict[str, Child], frames: int, on_progress: OnProgress | None) -> None:
    deadline = time.monotonic() + READY_WITHIN_S + SECONDS_PER_FRAME * frames * len(coordinators)
    watched = next(iter(coordinators.values()))
    while (ended := sim.poll()) is None:
        for child in coordinators.values():
            if (code := child.poll()) is not None:
                raise child.error(f"ended with {code} in the middle of the run")
        if time.monotonic() > deadline:
            raise sim.error(f"did not play {frames} frames in time")
        if on_progress:
            on_progress(min(watched.stdout_file.read_bytes().count(b"\n"), frames), frames)
        time.sleep(0.1)
    if ended:
        raise sim.error(f"ended with {ended}")
    if on_progress:
        on_progress(frames, frames)
