"""A real coordinator in real time, and a camera that one can be mean with: 30 Hz over LCM, with a clock of its own."""

from __future__ import annotations

import time

import numpy as np
from onboard import Onboard

from pilotfish import core
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t
from scenes import PERIOD_US, leader_pictures

PICTURES = leader_pictures(60)
OWN_CLOCK_US = 3 * 10**12  # a month beside this host's monotonic clock, and no date: nothing is known of it
GRAY = np.full((480, 640), 128, np.uint8)
PERIOD_S = PERIOD_US * 1e-6
PATIENCE_S = 0.4  # four times the age limit: what still moves then moves blindly, on however slow a machine


def noisy_gray(seed):
    """Without a leader, and different each time, as a sensor's picture is."""
    return (GRAY + np.random.default_rng(seed).integers(-3, 4, GRAY.shape)).astype(np.uint8)


def moves(command):
    return (command.linear_mps, command.angular_radps) != (0.0, 0.0)


class Robot(Onboard):
    """A coordinator in real time, and a camera that one can be mean with."""

    def __init__(self, folder, *options, **keywords):
        super().__init__(folder, *options, simulated=False, **keywords)
        self.sent = 0
        self.clock_shift_us = OWN_CLOCK_US
        self.next_s = None

    def now_us(self):
        """The camera's clock, which is not this host's: it may be set."""
        return time.monotonic_ns() // 1000 + self.clock_shift_us

    def show(self, image, utime=None):
        """One picture, exposed now unless it says otherwise; then a period of the camera's 30 Hz passes."""
        self.send_image(core.Frame(image, utime=self.now_us() if utime is None else utime))
        self.pass_a_period()

    def pass_a_period(self):
        start_s = time.monotonic()
        self.next_s = max((self.next_s or start_s) + PERIOD_S, start_s)
        while (left_s := self.next_s - time.monotonic()) > 0:
            self.bus.handle_timeout(max(int(left_s * 1e3), 1))

    def show_leader(self, frames):
        for _ in range(frames):
            self.show(PICTURES[self.sent % len(PICTURES)].image)
            self.sent += 1

    def follow(self, frames=20):
        """Drives behind the leader. The test tests nothing unless the robot moves."""
        first = len(self.commands)
        self.show_leader(frames)
        assert any(moves(c) for c in self.commands[first:]), self.child.error("it never moved")

    def tracked_since(self, first):
        return sum(c.status == command_t.STATUS_TRACKING for c in self.commands[first:])

    def moving_after(self, patience_s=PATIENCE_S, for_s=0.5):
        """The commands that still move the robot when `patience_s` have passed."""
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            self.bus.handle_timeout(10)
        first = len(self.commands)
        end = time.monotonic() + for_s
        while time.monotonic() < end or len(self.commands) - first < 5:
            assert time.monotonic() < end + 10, self.child.error("it fell silent")
            self.bus.handle_timeout(10)
        return [c for c in self.commands[first:] if moves(c)]

    def status(self):
        """The next status_t."""
        received = []
        subscription = self.bus.subscribe(
            f"{self.robot.upper()}_STATUS", lambda _, data: received.append(status_t.decode(data))
        )
        self.listen_until(lambda: bool(received), "a status")
        self.bus.unsubscribe(subscription)
        return received[-1]
