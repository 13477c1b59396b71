"""A wheel driver that executes a coordinator's commands: wheel_driver.py ROBOT [LCM_URL]. pilotfish-base does this,
and more, for differential drives; this is the minimum that is safe."""

import signal
import sys
import time

from pilotfish import bus, core

DEADLINE_US = 85_000  # without a command; the wheels stand still before 100 ms


def turn_wheels(twist: core.Twist) -> None:
    """Replace this by your motor controller."""
    print(f"v = {twist.linear_mps:+.3f} m/s, w = {twist.angular_radps:+.3f} rad/s", flush=True)


def now_us() -> int:
    return time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000


class Wheels:
    def __init__(self) -> None:
        self.guard: core.SequenceGuard | None = None  # accepts the first coordinator that sends, and no other
        self.until_us = 0
        self.moving = False

    def on_command(self, report: bus.CommandReport) -> None:
        if report.simulated or report.session == 0:
            return  # not for real wheels
        self.guard = self.guard or core.SequenceGuard(report.session)
        if self.guard.accept(report.session, report.counter) != core.SequenceVerdict.accepted:
            return
        # Not from now on: it may have waited in the queue, or its measurement may be old (on one computer).
        self.until_us = min(link.arrival_us + DEADLINE_US, report.valid_until_us)
        self.moving = now_us() < self.until_us  # for zeros there is no validity
        turn_wheels(report.command if self.moving else core.Twist())


if len(sys.argv) < 2:
    sys.exit(__doc__)
for number in (signal.SIGINT, signal.SIGTERM):  # leave the loop, and with it the wheels at zero
    signal.signal(number, lambda number, frame: sys.exit(128 + number))
link, wheels = bus.Bus(sys.argv[2] if len(sys.argv) > 2 else ""), Wheels()
link.on_command(sys.argv[1], wheels.on_command)
try:
    while True:
        link.handle(5)
        if wheels.moving and wheels.until_us <= now_us():
            wheels.moving = False
            turn_wheels(core.Twist())
except BrokenPipeError:  # nobody reads any more what stands for the wheels here
    sys.stdout = None
    sys.exit(141)
finally:
    turn_wheels(core.Twist())
