"""Wheels of one's own that obey a coordinator: wheel_driver.py ROBOT [LCM_URL]. pilotfish-base does this, and more, for
differential drives; this is the least that is safe."""

import sys
import time

from pilotfish import bus, core

DEADLINE_S = 0.1  # then the wheels stand still by themselves


def turn_wheels(twist: core.Twist) -> None:
    """Here belongs the motor controller."""
    print(f"v = {twist.linear_mps:+.3f} m/s, w = {twist.angular_radps:+.3f} rad/s", flush=True)


class Wheels:
    def __init__(self) -> None:
        self.guard: core.SequenceGuard | None = None  # the first coordinator that speaks is obeyed, and no other
        self.heard_s = 0.0
        self.moving = False

    def hear(self, report: bus.CommandReport) -> None:
        if report.simulated or report.session == 0:
            return  # not for real wheels
        self.guard = self.guard or core.SequenceGuard(report.session)
        if self.guard.accept(report.session, report.counter) != core.SequenceVerdict.accepted:
            return
        self.heard_s = link.arrival_us * 1e-6  # it may have waited since
        self.moving = (report.command.linear_mps, report.command.angular_radps) != (0.0, 0.0)
        turn_wheels(report.command)


if len(sys.argv) < 2:
    sys.exit(__doc__)
link, wheels = bus.Bus(sys.argv[2] if len(sys.argv) > 2 else ""), Wheels()
link.on_command(sys.argv[1], wheels.hear)
try:
    while True:
        link.handle(10)
        if wheels.moving and time.clock_gettime(time.CLOCK_BOOTTIME) - wheels.heard_s > DEADLINE_S - 0.015:
            wheels.moving = False
            turn_wheels(core.Twist())
finally:
    turn_wheels(core.Twist())
