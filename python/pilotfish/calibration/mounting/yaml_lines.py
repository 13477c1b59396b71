"""A mounting as the lines of a coordinator's configuration."""

from __future__ import annotations

import math

import numpy as np

from pilotfish.calibration.mounting.calibrate import MountingCalibration


def mounting_lines(calibration: MountingCalibration) -> str:
    """``camera: mounting: ...`` with one standard deviation of each number as a comment, to be pasted."""
    mounting, sigma = calibration.mounting, calibration.sigma
    place = ", ".join(f"{value + 0.0:.4f}" for value in mounting.position_m)
    mm = ", ".join("not observed" if np.isinf(s) else f"{s * 1e3:.1f}" for s in sigma[:3])
    lines = ["camera:", "  mounting:", f"    position_m: [{place}]  # forward, left, up; +- {mm} mm"]
    for k, name in enumerate(("pan", "tilt", "roll")):
        value = math.degrees(getattr(mounting, f"{name}_rad")) + 0.0
        known = "not observed" if np.isinf(sigma[3 + k]) else f"+- {math.degrees(sigma[3 + k]):.3f} deg"
        lines.append(f"    {name}_deg: {value:.3f}  # {known}")
    return "\n".join(lines) + "\n"
