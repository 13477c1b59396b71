"""Who looks, in which comparison."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

from bench.vision.baselines import Target, Wheels, apriltag, visp
from bench.vision.ours import Ours
from bench.vision.runs import Tracker
from bench.vision.scenes import LEADER, TAG_ID, TAG_SIZE_M
from pilotfish import core

TRACKED, ACQUIRED = "ours, tracked", "ours, acquired"
VISP_1, VISP_2 = "ViSP, decimate 1", "ViSP, decimate 2"
LIBAPRILTAG, WHEEL = "libapriltag 3.3.0", "AprilTag wheel"
THE_TARGET = Target(TAG_ID, TAG_SIZE_M)
ARUCO_SUBPIX, ARUCO_APRILTAG = "ArUco, subpix", "ArUco, apriltag"


@dataclass(frozen=True)
class Cast:
    """Makes trackers for a camera, new ones at every call."""

    compiled: ModuleType
    wheels: Wheels
    target: Target = THE_TARGET
    leader: core.LeaderBody = LEADER

    def trackers(self, camera: core.CameraModel, names: list[str]) -> list[Tracker]:
        """In the order of `names`."""
        return [self._makers(camera)[name]() for name in names]

    def _makers(self, camera: core.CameraModel) -> dict[str, Callable[[], Tracker]]:
        wheel = self.wheels.tracker
        return {
            TRACKED: lambda: Ours(camera, self.leader, tracking=True),
            ACQUIRED: lambda: Ours(camera, self.leader, tracking=False),
            VISP_1: lambda: visp(self.compiled, camera, self.target, 1),
            VISP_2: lambda: visp(self.compiled, camera, self.target, 2),
            LIBAPRILTAG: lambda: apriltag(self.compiled, camera, self.target),
            WHEEL: lambda: wheel("apriltag", WHEEL, camera, self.target),
            ARUCO_SUBPIX: lambda: wheel("aruco subpix", ARUCO_SUBPIX, camera, self.target),
            ARUCO_APRILTAG: lambda: wheel("aruco apriltag", ARUCO_APRILTAG, camera, self.target),
        }
