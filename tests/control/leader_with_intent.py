"""Closed loops with a leader that says how it moves, which may be the truth."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from pilotfish import coordinator, core, sim
from pilotfish import data as shipped
from pilotfish.harness.drawn_observations import DrawnObservations, ObservationNoise
from pilotfish.harness.in_process import Feed, run_in_process
from pilotfish.harness.scenario import Scenario
from pilotfish.recording import Recording

Word = Callable[[float, core.Twist], core.Twist | None]  # what it says, of the time and the truth; None: nothing
CAMERA_LATENCY_S = 1 / 30
COARSE = ObservationNoise(distance_sigma_per_m=0.25e-3, bearing_sigma_rad=1.0e-4, heading_sigma_rad_per_m=0.7e-3)


def twist(linear_mps: float, angular_radps: float = 0.0) -> core.Twist:
    return core.Twist(linear_mps=linear_mps, angular_radps=angular_radps)


@dataclass
class LeaderWithIntent:
    """Says 100 times a second what it does, and is received at once. A picture is answered one latency after its
    exposure, so by then everything up to that moment has been received, unless it takes delay_s more."""

    word: Word = lambda time_s, truth: truth
    delay_s: float = 0.0
    stamped_late_s: float = 0.0
    rate_hz: float = 100.0
    said: int = -1

    def feed(self, world: sim.World, robot: str, driver) -> None:
        leader = world.scenario.robot("leader")
        last = math.floor((world.time_s + CAMERA_LATENCY_S - self.delay_s) * self.rate_hz + 1e-6)
        for k in range(self.said + 1, last + 1):
            time_s = k / self.rate_hz
            said = self.word(time_s, sim.state_at(leader.trajectory, leader.start, time_s).twist)
            if said is not None:
                utime = sim.START_UTIME + round((time_s - self.stamped_late_s) * 1e6)
                driver.set_leader_intent(utime, said)
        self.said = max(self.said, last)


def follow(
    which: str,
    feed: Feed | None = None,
    *,
    seed: int = 1,
    duration_s: float | None = None,
    configure: Callable[[coordinator.CoordinatorConfig], None] | None = None,
) -> tuple[Recording, Counter[str]]:
    """A run with drawn measurements, and how often which use was made of announcements."""
    uses: Counter[str] = Counter()

    def count(event) -> None:
        if event.result and event.result.control:
            uses[event.result.control.leader_intent.name] += 1

    run = run_in_process(
        Scenario.load(shipped.path(f"scenarios/{which}.yaml")),
        profile="anticipate",
        drawn=DrawnObservations(seed, COARSE),
        feed=feed,
        configure=configure,
        duration_s=duration_s,
        on_frame=count,
    )
    return run.recordings["robot1"], uses
