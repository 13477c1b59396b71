#!/usr/bin/env python3
# A wheel driver to start from, for a robot that pilotfish-base cannot drive: write turn_wheels(), and keep the rest.
"""Executes the commands of one coordinator: wheel_driver.py [ROBOT] [LCM_URL].

For a differential drive on a serial line you need none of this: pilotfish-base does it, and more (limits, encoders,
a stop of its own, real-time priority). This is the minimum that is safe:

- one coordinator at a time, with rising counters: neither a second one nor a recording drives;
- the wheels stop 100 ms after the last good command, whatever happened to the coordinator, and earlier when the
  measurement behind the command becomes too old (valid_until_us, on this computer's clock);
- commands of a simulator do not drive real wheels;
- the wheels stop when this program ends.

It must run on the coordinator's computer (else it has to publish its clock: docs/operating-guide.md, "On a robot").
What SIGKILL or a crash of the computer leaves behind only the motor controller can stop: give it a timeout of its own.
"""

import signal
import sys
import time
from types import FrameType

from pilotfish import bus, core

ROBOT = "robot1"  # the coordinator's name: commands come on ROBOT1_COMMAND
DEADLINE_US = 85_000  # after a command; with the period of the loop below the wheels stand before 100 ms
LOOP_MS = 5
TAKEOVER_US = 500_000  # a coordinator that is silent for so long may be replaced, for instance after a restart


def turn_wheels(twist: core.Twist) -> None:
    """Replace this by your motor controller. It must return within a few milliseconds, and zero must stop the wheels.

    For a differential drive with wheels `track_m` apart: left = v - w * track_m / 2, right = v + w * track_m / 2 [m/s].
    """
    print(f"v = {twist.linear_mps:+.3f} m/s, w = {twist.angular_radps:+.3f} rad/s", flush=True)


def now_us() -> int:
    """This computer's clock, which valid_until_us is on."""
    return time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000


class Wheels:
    """Decides what the wheels do. Times are given, so that a test needs no clock."""

    def __init__(self, turn=turn_wheels) -> None:
        self._turn = turn
        self._guard: core.SequenceGuard | None = None
        self._ended: set[int] = set()  # sessions that were replaced: a recording of them drives nothing
        self._session = 0
        self._heard_us = 0
        self._until_us = 0
        self.moving = False

    def command(self, report: bus.CommandReport, arrival_us: int, at_us: int) -> None:
        """A command that arrived at `arrival_us` and is looked at now, at `at_us`."""
        if report.simulated or report.session == 0 or not self._is_from_our_coordinator(report, at_us):
            return
        self._heard_us = at_us
        # Not from now on: it may have waited in the queue, or its measurement may be old.
        self._until_us = min(arrival_us + DEADLINE_US, report.valid_until_us)
        self.moving = at_us < self._until_us  # for zeros there is no validity
        self._turn(report.command if self.moving else core.Twist())

    def tick(self, at_us: int) -> None:
        """To be called every few milliseconds: stops the wheels when no good command holds any more."""
        if self.moving and at_us >= self._until_us:
            self.moving = False
            self._turn(core.Twist())

    def _is_from_our_coordinator(self, report: bus.CommandReport, at_us: int) -> bool:
        if report.session in self._ended:
            return False
        if self._guard is None or (report.session != self._session and at_us - self._heard_us > TAKEOVER_US):
            if self._guard is not None:
                self._ended.add(self._session)
            self._session, self._guard = report.session, core.SequenceGuard(report.session)
        return self._guard.accept(report.session, report.counter) == core.SequenceVerdict.accepted


def end(_number: int, _frame: FrameType | None) -> None:
    """systemctl stop and Ctrl-C: leaves the loop, and with it the wheels at zero."""
    sys.exit(0)


def main() -> None:
    """Runs until it is told to end."""
    robot, url = [*sys.argv[1:], ROBOT, ""][:2] if len(sys.argv) < 3 else sys.argv[1:3]
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, end)
    link, wheels = bus.Bus(url), Wheels()
    link.on_command(robot, lambda report: wheels.command(report, link.arrival_us, now_us()))
    print(f"wheels of {robot} on {link.url}", file=sys.stderr, flush=True)
    try:
        while True:
            link.handle(LOOP_MS)
            wheels.tick(now_us())
    finally:
        turn_wheels(core.Twist())


if __name__ == "__main__":
    main()
