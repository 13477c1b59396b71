"""Coordinators that are driven at random, with a black box that listens."""

from __future__ import annotations

import random
import time
from pathlib import Path

import numpy as np

from pilotfish import blackbox, coordinator, core
from pilotfish import data as shipped
from pilotfish.core import Reason

CONFIG_PATH = str(shipped.path("config/line.yaml"))
PERIOD_US = 33_333
LAWS = [("fuzzy", "anticipate"), ("fuzzy", "paper"), ("pid", "paper"), ("pbvs", "paper")]


def wait_until(condition, timeout_s=20.0):
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline, "has not happened in time"
        time.sleep(0.002)


class RecordedRun:
    """A coordinator and its black box with the same inputs; keeps what it answered."""

    def __init__(
        self, folder: Path, *, law="fuzzy", profile="anticipate", robot="robot1", config=CONFIG_PATH, **black_box
    ):
        self.overrides = coordinator.ConfigOverrides(law=law, profile=profile)
        self.bundle = coordinator.bundle_config(str(config), self.overrides)
        self.config = coordinator.load_bundle(self.bundle).coordinator
        self.core = coordinator.Coordinator(self.config)
        settings = coordinator.BlackBoxConfig(directory=str(folder), **black_box)
        self.box = blackbox.BlackBox(
            settings, robot=robot, coordinator=self.core, bundle=self.bundle, session=1234, command_line="a test"
        )
        self.handed_over = 1  # the start
        self.results = []

    def see(self, utime, observation, now_us, reason=Reason.no_tag_found, known_age_us=0):
        result = self.core.step_observation(utime, observation, now_us, reason, known_age_us)
        self.box.frame(utime, known_age_us, now_us, result, self.core)
        return self._keep(result)

    def see_each(self, utime, observations, now_us):
        """One observation, or None, of each leader."""
        result = self.core.step_observations(utime, observations, now_us)
        self.box.frame(utime, 0, now_us, result, self.core)
        return self._keep(result)

    def look(self, frame, now_us):
        result = self.core.step(frame, now_us)
        self.box.frame(frame.utime, frame.known_age_us, now_us, result, self.core, frame.coarse_search)
        return self._keep(result)

    def set_setpoint(self, setpoint):
        self.handed_over += 1
        self.box.setpoint(setpoint, self.core.set_setpoint(setpoint), self.core)

    def set_ego_motion(self, utime, twist):
        self.handed_over += 1
        self.box.ego_motion(utime, twist, self.core.set_ego_motion(utime, twist), self.core)

    def set_leader_intent(self, utime, twist):
        self.handed_over += 1
        self.box.leader_intent(utime, twist, self.core.set_leader_intent(utime, twist), self.core)

    def send(self, now_us, missing=Reason.no_frame):
        held = self.core.held
        status, reason, command = held.at(now_us, missing)
        self.handed_over += 1
        self.box.sent(held, now_us=now_us, missing=missing, status=status, reason=reason, command=command)

    def message(self, channel, data):
        self.handed_over += 1
        self.box.message(channel, data)

    def flush(self):
        """Everything handed over so far has met its fate (starts that the box adds count, too)."""
        wait_until(lambda: self.box.written + self.box.lost + self.box.dropped >= self.handed_over)

    def close(self):
        del self.box

    def _keep(self, result):
        self.handed_over += 1
        self.results.append(result)
        return result


def observation_at(utime, distance_m, bearing_rad=0.0, heading_rad=0.0, **more):
    sigma = np.array([0.002, 0.001, 0.02])
    return core.Observation(
        utime=utime,
        distance_m=distance_m,
        bearing_rad=bearing_rad,
        heading_rad=heading_rad,
        covariance=np.diag(sigma**2),
        **more,
    )


def drive_at_random(run: RecordedRun, count: int, seed: int) -> None:
    """Frames that are measured, missed, late, repeated or of a clock that was set; everything else in between."""
    chance = random.Random(seed)
    now_us, offset_us = 10_000_000_000, 500_000_000
    distance_m, bearing_rad, speed = 1.5, 0.0, 0.1
    for _ in range(count):
        now_us += chance.choice([PERIOD_US] * 8 + [1000, 120_000, 400_000])
        if chance.random() < 0.01:
            offset_us += chance.choice([-3_600_000_000, 3_600_000_000, -80_000])
        utime = now_us + offset_us - chance.choice([0] * 8 + [5000, 90_000, 150_000])
        speed = min(max(speed + chance.gauss(0, 0.02), -0.3), 0.3)
        distance_m = min(max(distance_m + speed / 30 - 0.002, 0.5), 3.0)
        bearing_rad += chance.gauss(0, 0.01)
        kind = chance.random()
        if kind < 0.75:
            seen = observation_at(utime, distance_m + chance.gauss(0, 0.002), bearing_rad, chance.gauss(0, 0.1))
            run.see(utime, seen, now_us, known_age_us=chance.choice([0, 0, 0, 4000, -2000, 200_000]))
        else:
            why = chance.choice([Reason.no_tag_found, Reason.tag_refused, Reason.camera_frozen, Reason.leader_jumped])
            run.see(utime, None, now_us, why)
        if chance.random() < 0.3:
            twist = core.Twist(linear_mps=chance.gauss(0, 0.4), angular_radps=chance.gauss(0, 0.5))
            run.set_ego_motion(utime + chance.choice([-20_000, 5000, 10**7]), twist)
        if chance.random() < 0.3:
            run.set_leader_intent(utime, core.Twist(linear_mps=speed, angular_radps=0.0))
        if chance.random() < 0.05:
            where = {"distance_m": chance.uniform(0.35, 2.0), "bearing_rad": chance.uniform(-0.5, 0.5)}
            run.set_setpoint(core.Setpoint(**where, run=chance.random() < 0.9))
        if chance.random() < 0.5:
            run.send(
                now_us + chance.choice([0, 50_000, 99_000, 101_000]), chance.choice([Reason.no_frame, Reason.none])
            )
