"""A formation driven by the real programs: one coordinator for each robot, whose setpoint is changed by message while
it drives."""

from __future__ import annotations

import contextlib

from pilotfish.formation.file import Formation
from pilotfish.formation.run import Asked, same, setpoint_at
from pilotfish.harness.over_lcm import run_over_lcm
from pilotfish.harness.ports import private_lcm_url
from pilotfish.harness.run import OnProgress, Run
from pilotfish.harness.scenario import Scenario
from pilotfish.operating import Operator
from pilotfish.sim import START_UTIME


def run_with_messages(
    formation: Formation,
    scenario: Scenario,
    law: str,
    duration_s: float | None,
    on_progress: OnProgress | None,
) -> tuple[Run, Asked]:
    """The run, and since when each robot kept which setpoint: the time of the picture whose status showed it first. The
    simulator does not wait for these messages, so a change comes some pictures later than ``at_s``."""
    url = private_lcm_url()
    asked: Asked = {robot: [(0.0, setpoint_at(formation, robot, 0.0))] for robot in formation.leaders}
    with contextlib.ExitStack() as stack:
        operators: dict[str, Operator] = {}

        def send(done: int, total: int) -> None:
            time_s = done / scenario.frame_rate_hz
            for robot, before in asked.items():
                setpoint = setpoint_at(formation, robot, time_s)
                if same(before[-1][1], setpoint) or done >= total:
                    continue
                if robot not in operators:
                    operators[robot] = Operator(robot, lcm_url=url)
                status = operators[robot].set_setpoint(distance_m=setpoint.distance_m, bearing_rad=setpoint.bearing_rad)
                before.append(((status.utime - START_UTIME) * 1e-6, setpoint))
            if on_progress:
                on_progress(done, total)

        stack.callback(operators.clear)
        run = run_over_lcm(scenario, profile=law, duration_s=duration_s, lcm_url=url, on_progress=send)
    return run, asked
