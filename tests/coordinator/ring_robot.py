"""A coordinator with a ring of sonars, given measurements instead of pictures."""

import math

from pilotfish import coordinator, core
from pilotfish import data as shipped

FRAME_US = 33_333
START_US = 5_000_000
SENSORS = 24


def settings(**sections):
    """The shipped configuration with obstacles; sections: changes, as avoidance={"max_age_s": 0.1}."""
    config = coordinator.load_coordinator(shipped.path("config/obstacles.yaml")).coordinator
    law = config.control
    for name, changes in sections.items():
        section = getattr(law, name)
        for key, value in changes.items():
            setattr(section, key, value)
        setattr(law, name, section)
    config.control = law
    return config


def ring(utime, surfaces=(), free_m=3.0):
    """What 24 sonars of 15 degrees read; surfaces: (direction [rad], range [m]) of points, each read by the sensor
    whose cone it is in."""
    ranges = [free_m] * SENSORS
    for direction_rad, range_m in surfaces:
        sensor = int((math.degrees(direction_rad) % 360 + 180) % 360 // 15)
        ranges[sensor] = min(ranges[sensor], range_m)
    return core.RangeScan(utime=utime, first_rad=math.radians(-172.5), step_rad=math.radians(15.0), ranges_m=ranges)


def leader_at(utime, distance_m=1.1, bearing_rad=-math.pi / 12, heading_rad=0.0):
    return core.Observation(utime=utime, distance_m=distance_m, bearing_rad=bearing_rad, heading_rad=heading_rad)


class Robot:
    """Frames at 30 Hz; a ring before each, unless told otherwise. Time passes as the stamps do."""

    def __init__(self, config=None):
        self.core = coordinator.Coordinator(config or settings())
        self.now_us = START_US
        self.core.step_observation(self.now_us, None, self.now_us)  # ranges count from the first frame on

    def step(self, seen=True, *, surfaces=(), ranges=True, free_m=3.0, **leader):
        """One frame later. seen: the leader is where ``leader`` says."""
        self.now_us += FRAME_US
        if ranges:
            assert self.core.set_ranges(ring(self.now_us, surfaces, free_m), self.now_us)
        observation = leader_at(self.now_us, **leader) if seen else None
        return self.core.step_observation(self.now_us, observation, self.now_us)

    def steps(self, count, seen=True, **how):
        return [self.step(seen, **how) for _ in range(count)]
