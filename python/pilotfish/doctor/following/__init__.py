"""Why a robot does not follow: watches a running coordinator over LCM, and says what it finds.

from pilotfish.doctor import following
diagnosis = following.diagnose("robot1", seconds=10.0)
print(diagnosis.follows, *diagnosis.causes, sep="\\n")
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pilotfish.bus import DEFAULT_URL
from pilotfish.doctor.following.base_here import BaseHere, find_base
from pilotfish.doctor.following.cause import Cause
from pilotfish.doctor.following.causes import causes
from pilotfish.doctor.following.evidence import Evidence, collect
from pilotfish.doctor.following.in_view import DEFAULT_FAMILY, InView, look
from pilotfish.doctor.following.load import Machine, cpu_times, machine_load
from pilotfish.doctor.following.no_coordinator import no_coordinator
from pilotfish.doctor.following.setup import (
    Setup,
    find_setup,
    load_setup,
    running,
    running_coordinators,
    runs_here,
)
from pilotfish.doctor.following.watch import Watched, watch_robot
from pilotfish.doctor.following.whom import whom
from pilotfish.doctor.host import Host

__all__ = ["Cause", "Diagnosis", "Evidence", "Setup", "diagnose"]


@dataclass(frozen=True)
class Diagnosis:
    """``causes``: what keeps it from following, the most likely first; none: it follows. ``notes`` do not keep it."""

    robot: str
    seconds: float
    lcm_url: str
    causes: list[Cause]
    notes: list[Cause]
    evidence: Evidence | None  # None without a coordinator
    setup: Setup | None  # None where its configuration is not known
    in_view: InView | None  # None without pictures on the bus
    machine: Machine | None = None  # None unless its coordinator runs on this computer
    base_here: BaseHere | None = None  # None where the configuration of its wheels' process is not known

    @property
    def follows(self) -> bool:
        """Nothing keeps it from following."""
        return not self.causes

    def as_dict(self) -> dict[str, Any]:
        """For JSON: numbers that are not known are null."""
        return {
            "robot": self.robot,
            "follows": self.follows,
            "seconds": self.seconds,
            "lcm_url": self.lcm_url,
            "causes": [cause.as_dict() for cause in self.causes],
            "notes": [cause.as_dict() for cause in self.notes],
            "evidence": _plain(asdict(self.evidence)) if self.evidence else None,
            "config": str(self.setup.file) if self.setup else None,
            "base_config": str(self.base_here.file) if self.base_here else None,
            "base_driver": (self.base_here.driver or None) if self.base_here else None,
            "machine": asdict(self.machine) if self.machine else None,
            "ids_in_view": list(self.in_view.ids) if self.in_view else None,
        }


def diagnose(
    robot: str,
    *,
    seconds: float = 10.0,
    lcm_url: str = "",
    config: Path | None = None,
    host: Host | None = None,
    on_time: Callable[[float], None] = lambda passed_s: None,
) -> Diagnosis:
    """Watches for ``seconds``; ``on_time`` gets the time that has passed [s]. ConfigError for a wrong ``config``,
    SilentRobotError if there is no bus. Sends nothing."""
    host = host or Host()
    url = lcm_url or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL
    given = load_setup(config, robot) if config else None
    before = cpu_times(host)
    watched = watch_robot(robot, url, seconds, on_time)
    machine = machine_load(host, before)
    processes = running_coordinators(host)
    found_running = find_setup(robot, url, processes)
    setup = given or found_running
    if given and found_running and given.file.resolve() == found_running.file.resolve():
        given = None  # its coordinator is called so by its command line
    if not watched.statuses and not watched.commands:
        found, notes = no_coordinator(watched, url, processes, host), whom(robot, (), given)
        return Diagnosis(robot, seconds, url, found, notes, None, setup, None)
    base_here = find_base(robot, url, running(host, "pilotfish-base"), setup)
    here = runs_here(robot, url, processes)
    return judge(watched, url, setup, machine=machine if here else None, base_here=base_here, given=given)


def judge(
    watched: Watched,
    url: str,
    setup: Setup | None,
    *,
    machine: Machine | None = None,
    base_here: BaseHere | None = None,
    given: Setup | None = None,
) -> Diagnosis:
    """The diagnosis of what was received of a coordinator; ``machine``: the computer that it runs on, if known;
    ``base_here``: what its wheels' process is set to, if known; ``given``: as of whom()."""
    evidence = collect(watched, wall_offset_s=time.time() - time.monotonic())
    channel = (setup.image_channel if setup else None) or f"{watched.robot.upper()}_IMAGE"
    in_view = look(watched, channel, setup.family if setup else DEFAULT_FAMILY)
    found, notes = causes(watched.robot, evidence, setup, in_view, machine, base_here)
    notes = whom(watched.robot, watched.others, given) + notes
    return Diagnosis(watched.robot, watched.seconds, url, found, notes, evidence, setup, in_view, machine, base_here)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {"x".join(map(str, key)) if isinstance(key, tuple) else key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and value != value else value
