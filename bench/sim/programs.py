"""Many real pilotfish-coordinator processes and one pilotfish-sim --realtime, on one bus."""

from __future__ import annotations

import re
import resource
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from bench.common.statistics import quantile
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.harness.frame_report import parse_reports
from pilotfish.harness.ports import private_lcm_url
from pilotfish.harness.scenario import Scenario

READY_WITHIN_S = 60.0
_OVER = re.compile(r"(\d+) exposures, (\d+) pictures delivered, (\d+) dropped, \d+ sent again, (\d+) skipped")


@dataclass(frozen=True)
class Programs:
    """Whether they keep up."""

    robots: int
    exposures: int  # that the simulator took
    skipped: int  # that real time left it no time for
    delivered: int  # pictures that it sent
    answered: int  # of these, how many a coordinator looked at
    tracked: int  # and in how many it measured its leader
    latency_p50_ms: float  # from a picture's arrival to its command; each the median of a coordinator's last frames
    latency_p99_ms: float
    processor_s_per_s: float  # of all programs together, over the time that was simulated
    duration_s: float


def play_programs(scenario_file: Path, duration_s: float) -> Programs:
    """Plays the scenario in real time. HarnessError with what the failing program said."""
    scenario = Scenario.load(scenario_file)
    url = private_lcm_url()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory(prefix="pilotfish-") as temporary, ExitStack() as children:
        folder = Path(temporary)
        coordinators = []
        for robot in scenario.robots:
            command = [find_executable(COORDINATOR), "--config", robot.coordinator_file, "--name", robot.name]
            command += ["--source", "lcm", "--lcm-url", url, "--json", "--quiet"]
            coordinators.append(children.enter_context(Child(command, folder, robot.name)))
        command = [find_executable(SIM), "--scenario", scenario_file, "--lcm-url", url, "--realtime"]
        command += ["--duration-s", str(duration_s), "--wait-s", str(READY_WITHIN_S)]
        sim = children.enter_context(Child(command, folder, "sim"))
        sim.wait_until(
            lambda: sim.process.poll() is not None, READY_WITHIN_S + 10.0 * duration_s, "the end of the scenario"
        )
        if sim.process.returncode:
            raise sim.error(f"ended with {sim.process.returncode}")
        for child in coordinators:
            child.terminate()
        over = _OVER.search(sim.stderr())
        if over is None:
            raise sim.error("did not say what it played")
        exposures, delivered, _, skipped = map(int, over.groups())
        reports = [report for child in coordinators for report in parse_reports(child.stdout().splitlines())]
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor_s = used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime
    latencies_ms = [1e3 * report.latency_s for report in reports if report.latency_s]
    return Programs(
        robots=len(scenario.robots),
        exposures=exposures,
        skipped=skipped,
        delivered=delivered,
        answered=len(reports),
        tracked=sum(report.distance_m is not None for report in reports),
        latency_p50_ms=quantile(latencies_ms, 0.5),
        latency_p99_ms=quantile(latencies_ms, 0.99),
        processor_s_per_s=processor_s / duration_s,
        duration_s=duration_s,
    )
