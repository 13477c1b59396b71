"""Observations without pictures: measurements drawn from a distribution, for runs that are to be a hundred times faster
than rendering them. Everything behind the observer is the real thing."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pilotfish import coordinator, core, sim


@dataclass(frozen=True)
class ObservationNoise:
    """White Gaussian noise of a measurement. By default what rendered pictures of 640 x 480 have, of a leader with
    tags on three faces at 0.65 to 2.4 m, measured in both experiments."""

    distance_sigma_per_m: float = 0.03e-3  # sigma of d = this times d^2: the tag shrinks as 1/d
    bearing_sigma_rad: float = 0.015e-3
    heading_sigma_rad_per_m: float = 0.08e-3  # sigma of psi = this times d

    def covariance(self, distance_m: float) -> np.ndarray:
        """(3, 3), of (distance_m, bearing_rad, heading_rad)."""
        matrix = np.zeros((3, 3))
        matrix[0, 0] = (self.distance_sigma_per_m * distance_m**2) ** 2
        matrix[1, 1] = self.bearing_sigma_rad**2
        matrix[2, 2] = (self.heading_sigma_rad_per_m * distance_m) ** 2
        return matrix


@dataclass
class DrawnObservations:
    """What a coordinator measures of the leader, drawn around the truth. Nothing outside the camera's view or
    while the leader is hidden; with ``occlusion`` also by obstacles and other robots."""

    seed: int
    noise: ObservationNoise = field(default_factory=ObservationNoise)
    scale: float = 1.0  # of the noise; what is claimed stays
    half_view_rad: float = np.radians(26.0)  # the camera's, less half a tag
    vibration_rad: float = 0.0  # standard deviation of the camera's pitch and of its roll; no covariance claims it
    vibration_hz: float | None = None  # of a sine; None: white, new in every frame
    drop_probability: float = 0.0  # of a picture never being delivered
    occlusion: bool = False  # obstacles and other robots hide the leader

    def __post_init__(self) -> None:
        self._random = np.random.default_rng(self.seed)
        self._hidden: tuple[sim.World | None, dict[str, tuple[float, float]]] = (None, {})

    def delivers(self) -> bool:
        """Whether this picture is delivered; asked once for each, before look()."""
        return not self.drop_probability or bool(self._random.random() >= self.drop_probability)

    def look(self, world: sim.World, robot: str) -> core.Observation | None:
        """What the robot sees now, with drawn errors; None if the leader is hidden or beyond the edge of the view."""
        distance_m, bearing_rad, heading_rad = world.true_relative_pose(robot)
        covariance = self.noise.covariance(distance_m)
        errors = self.scale * self._random.standard_normal(3) * np.sqrt(covariance.diagonal())
        if self.vibration_rad:
            errors += self._shaken(world, robot, distance_m)
        hidden_from_s, hidden_until_s = self._hidden_s(world, robot)
        if hidden_from_s <= world.time_s < hidden_until_s or abs(bearing_rad) > self.half_view_rad:
            return None
        if self.occlusion and not world.leader_in_sight(robot):
            return None
        return core.Observation(
            utime=world.utime,
            distance_m=distance_m + errors[0],
            bearing_rad=bearing_rad + errors[1],
            heading_rad=heading_rad + errors[2],
            covariance=covariance,
        )

    def _hidden_s(self, world: sim.World, robot: str) -> tuple[float, float]:
        """From when until when the leader is hidden. Kept, because every access to a scenario copies all its robots."""
        if self._hidden[0] is not world:
            self._hidden = (world, {})
        spans = self._hidden[1]
        if robot not in spans:
            scenario = world.scenario
            seen = scenario.robot(scenario.robot(robot).follows).visibility
            spans[robot] = (seen.hidden_from_s, seen.hidden_until_s)
        return spans[robot]

    def _shaken(self, world: sim.World, robot: str, distance_m: float) -> np.ndarray:
        """Errors of (d, theta, psi). The origin lies on the ground, h below the camera: a pitch moves it by h times
        that angle along the line of sight, a roll as much across it."""
        if self.vibration_hz is None:
            pitch, roll = self.vibration_rad * self._random.standard_normal(2)
        else:  # a sine's standard deviation is its amplitude over sqrt(2); the two are not in step
            phase = 2 * np.pi * self.vibration_hz * world.time_s
            pitch, roll = np.sqrt(2) * self.vibration_rad * np.sin([phase, phase + 1.0])
        height_m = world.scenario.robot(robot).camera.mounting.position_m[2]
        return height_m * np.array([pitch, roll / distance_m, 0.0])

    def answer(self, world: sim.World, robot: str, driver: coordinator.Coordinator) -> coordinator.StepResult:
        """The StepResult of ``driver`` for what it sees now."""
        return driver.step_observation(world.utime, self.look(world, robot), world.utime)
