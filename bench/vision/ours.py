"""Pilotfish's tracker, in the two ways in which it sees. This file alone knows the API of pilotfish.vision."""

from __future__ import annotations

import time

import numpy as np

from bench.vision.answers import Answer, Claim
from pilotfish import core, vision


class Ours:
    """A LeaderObserver as the coordinator uses it. Tracking, it remembers the frame before; acquiring, it forgets it
    before every frame. The clock runs around the call from Python, binding included."""

    def __init__(
        self,
        camera: core.CameraModel,
        leader: core.LeaderBody,
        *,
        tracking: bool,
        config: vision.LeaderObserverConfig | None = None,
    ):
        self.name = "ours, tracked" if tracking else "ours, acquired"
        self._tracking, self._leader = tracking, leader
        self._observer = vision.LeaderObserver(
            camera=camera, body=leader, config=config or vision.LeaderObserverConfig()
        )

    def track(self, image: np.ndarray, utime: int) -> Answer:
        """The answer to one frame; frames come in the order of their utime."""
        if not self._tracking:
            self.forget()
        frame = core.Frame(image, utime=utime)  # a copy, as a camera's driver makes one
        start = time.perf_counter_ns()
        sight = self._observer.observe(frame)
        elapsed_ns = time.perf_counter_ns() - start
        if sight.observation is None:
            return Answer(elapsed_ns)
        seen = sight.observation
        cMt = np.asarray(seen.cMo) @ self._leader.tags[0].oMt
        claim = Claim(np.array([seen.distance_m, seen.bearing_rad, seen.heading_rad]), np.asarray(seen.covariance))
        return Answer(elapsed_ns, cMt, seen.heading_rad, found_by_of(seen), claim)

    def forget(self) -> None:
        """The next frame is acquired from nothing."""
        self._observer.forget()


def found_by_of(observation: core.Observation) -> str:
    """How the leader was found: "track", "region" or "frame"."""
    return observation.found_by.name
