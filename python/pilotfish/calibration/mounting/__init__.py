"""Calibrating where the camera sits on its robot, from tags that stand still while the robot turns and drives.

``calibrate_mounting`` takes what ``calibration.body.collect_sightings`` has seen; ``drive`` derives what can be known.
"""

from pilotfish.calibration.mounting.calibrate import HeightKnown, MountingCalibration, calibrate_mounting
from pilotfish.calibration.mounting.phases import Odometry, Phases, phases_by_motion, phases_by_odometry

__all__ = [
    "HeightKnown",
    "MountingCalibration",
    "Odometry",
    "Phases",
    "calibrate_mounting",
    "phases_by_motion",
    "phases_by_odometry",
]
