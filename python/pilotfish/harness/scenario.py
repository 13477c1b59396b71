"""A scenario as the harness needs it: who follows whom, what they were asked to keep, how long it takes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from pilotfish import coordinator, sim
from pilotfish.core import Setpoint
from pilotfish.errors import ConfigError, MissingFileError
from pilotfish.recording import Recording


@dataclass(frozen=True)
class FollowingRobot:
    """A robot that a coordinator drives."""

    name: str
    leader: str
    coordinator_file: Path
    setpoint: Setpoint  # the scenario's if it says one, else that of the coordinator's own file


@dataclass(frozen=True)
class Scenario:
    """A scenario file, read and checked."""

    file: Path
    name: str
    duration_s: float
    frame_rate_hz: float
    robots: tuple[FollowingRobot, ...]

    @classmethod
    def load(cls, file: str | Path) -> Scenario:
        """Raises ConfigError naming the key, also if a coordinator's file is at fault or no robot follows
        anybody."""
        file = Path(file)
        if not file.is_file():
            raise MissingFileError(f"no scenario file {file}")
        try:
            spec = sim.load_scenario(file)
            robots = tuple(_following_robot(robot) for robot in spec.robots if robot.coordinator_file)
        except ValueError as error:
            raise ConfigError(f"{file}: {error}") from error
        if not robots:
            raise ConfigError(f"{file}: robots: no robot follows another (none has a 'coordinator')")
        return cls(file, spec.name, spec.duration_s, spec.frame_rate_hz, robots)

    def robot(self, name: str | None = None) -> FollowingRobot:
        """The robot of that name; the first one if none is given."""
        if name is None:
            return self.robots[0]
        for robot in self.robots:
            if robot.name == name:
                return robot
        there = ", ".join(robot.name for robot in self.robots)
        raise ConfigError(f"{self.file}: no coordinator drives a robot '{name}'; there are: {there}")

    def frame_count(self, duration_s: float) -> int:
        """Exposures at k / frame_rate_hz, k = 0, 1, ..., before duration_s."""
        return max(1, math.ceil(duration_s * self.frame_rate_hz - 1e-9))

    def annotate(self, recording: Recording, profile: str, transport: str) -> Recording:
        """The recording with the setpoint its robot had, and where it came from."""
        setpoint = self.robot(recording.meta.robot).setpoint
        return recording.with_meta(
            scenario=self.name,
            profile=profile,
            transport=transport,
            distance_setpoint_m=setpoint.distance_m,
            bearing_setpoint_rad=setpoint.bearing_rad,
        )


def _following_robot(spec: sim.RobotSpec) -> FollowingRobot:
    own = coordinator.load_coordinator(spec.coordinator_file).coordinator.setpoint
    return FollowingRobot(
        name=spec.name,
        leader=spec.follows,
        coordinator_file=Path(spec.coordinator_file),
        setpoint=spec.setpoint if spec.setpoint is not None else own,
    )
