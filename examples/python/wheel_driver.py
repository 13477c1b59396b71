"""A wheel driver that executes a coordinator's commands: wheel_driver.py ROBOT [LCM_URL]. pilotfish-base does this,
and more, for differential drives; this is the minimum that is safe."""

import sys
import time

from pilotfish import bus, core

DEADLINE_S = 0.1  # then the wheels stop without a command


def turn_wheels(twist: core.Twist) -> None:
    """Replace this by your motor controller."""
    print(f"v = {twist.linear_mps:+.3f} m/s, w = {twist.angular_radps:+.3f} rad/s", flush=True)


class Wheels:
    def __init__(self) -> None:
        self.guard: core.SequenceGuard | None = None  # accepts the first coordinator that sends, and no other
        self.arrival_s = 0.0
        self.moving = False

    def on_command(self, report: bus.CommandReport) -> None:
        if report.simulated or report.session == 0:
            return  # not for real wheels
        self.guard = self.guard or core.SequenceGuard(report.session)
        if self.guard.accept(report.session, report.counter) != core.SequenceVerdict.accepted:
            return
        self.arrival_s = link.arrival_us * 1e-6  # not now: it may have waited in the queue
        self.moving = (report.command.linear_mps, report.command.angular_radps) != (0.0, 0.0)
        turn_wheels(report.command)


if len(sys.argv) < 2:
    sys.exit(__doc__)
link, wheels = bus.Bus(sys.argv[2] if len(sys.argv) > 2 else ""), Wheels()
link.on_command(sys.argv[1], wheels.on_command)
try:
    while True:
        link.handle(10)
        if wheels.moving and time.clock_gettime(time.CLOCK_BOOTTIME) - wheels.arrival_s > DEADLINE_S - 0.015:
            wheels.moving = False
            turn_wheels(core.Twist())
finally:
    turn_wheels(core.Twist())
