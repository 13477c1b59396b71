"""Commands that were right when they were made, and reach the wheels too late: both programs, in real time."""

from __future__ import annotations

import lcm
import pytest
from real_time_robot import Robot

from build_tree import built
from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, find_executable
from pilotfish.lcmtypes.pilotfish.base_t import base_t


class Wheels:
    """pilotfish-base beside the coordinator, with no wheels: what it would command them is in its reports."""

    def __init__(self, folder, url):
        config = shipped.path("config/base.yaml")
        self.child = Child([find_executable(BASE), "--config", config, "--lcm-url", url], folder, "wheels")
        self.reports = []
        self.bus = lcm.LCM(url)
        self.bus.subscribe("ROBOT1_BASE", lambda _, data: self.reports.append(base_t.decode(data)))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.child.terminate()

    def reports_now(self):
        """Those that have come since the last call."""
        while self.bus.handle_timeout(0) > 0:
            pass
        new, self.reports = self.reports, []
        return new


def show_until(robot, wheels, condition, what, pictures=300):
    for _ in range(pictures):
        robot.show_leader(1)
        if any(condition(report) for report in wheels.reports_now()):
            return
    raise AssertionError(robot.child.error(f"{what}: not within {pictures} pictures"))


def expired(report):
    return {c.name: c.count for c in report.rejected}.get("command_expired", 0)


@pytest.mark.fault("commands_held_up")
def test_commands_that_leave_150_ms_after_they_were_checked_move_no_wheels(tmp_path, monkeypatch):
    """Their measurements are at least 150 ms old when they arrive; the limit is 100 ms."""
    stall = tmp_path / "stall"
    monkeypatch.setenv("LD_PRELOAD", str(built("libstalled_sending.so")))
    monkeypatch.setenv("PILOTFISH_STALL", str(stall))
    with Robot(tmp_path) as robot, Wheels(tmp_path, robot.url) as wheels:
        show_until(robot, wheels, lambda r: r.linear_mps != 0.0, "wheels that turn")
        for stalls in range(1, 6):
            for _ in range(10):  # the one that is held up may be a zero, which may come late
                stall.touch()
                show_until(robot, wheels, lambda _: not stall.exists(), "a command")
                robot.show_leader(15)
                if any(expired(report) >= stalls for report in wheels.reports_now()):
                    break
            else:
                raise AssertionError(f"{stalls - 1} refused; the next ten that were late were executed")
        show_until(robot, wheels, lambda r: r.linear_mps != 0.0, "wheels that turn again")
