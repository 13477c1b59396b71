"""What is said about a camera's mounting on the console."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.table import Table

from pilotfish.calibration.mounting import MountingCalibration
from pilotfish.cli.console import console, warn

if TYPE_CHECKING:
    from pilotfish.calibration.mounting.odometry_check import OdometryScales

_WHENCE = ("turning centre", "turning centre", "", "straight drive", "turning axis", "turning axis")


def print_mounting_report(calibration: MountingCalibration, scales: OdometryScales | None) -> None:
    """The six numbers, what the robot did, what could not be seen, and the warnings."""
    mounting, sigma = calibration.mounting, calibration.sigma
    table = Table(title="the camera on its robot", box=SIMPLE_HEAD)
    for column in ("", "value", "± (1 sigma)", "from"):
        table.add_column(column, justify="left" if column == "from" else "right")
    values = [*(1e3 * v for v in mounting.position_m)]
    values += [math.degrees(v) for v in (mounting.pan_rad, mounting.tilt_rad, mounting.roll_rad)]
    spreads = [*(1e3 * s for s in sigma[:3]), *(math.degrees(s) for s in sigma[3:])]
    names, units = ("forward", "left", "up", "pan", "tilt", "roll"), ("mm",) * 3 + ("°",) * 3
    rows = zip(names, values, spreads, units, strict=True)
    for k, (name, value, spread, unit) in enumerate(rows):
        digits = 1 if unit == "mm" else 3
        if np.isinf(spread):
            table.add_row(name, f"{value + 0.0:.{digits}f} {unit}", "not seen", "")
        else:
            whence = "what was measured" if k == 2 else _WHENCE[k]
            table.add_row(name, f"{value + 0.0:.{digits}f} {unit}", f"{spread:.{digits}f} {unit}", whence)
    console.print(table)
    slip = calibration.slip
    said = (
        f"{calibration.pictures[0]} pictures of a turn by {math.degrees(calibration.turned_rad):.0f} degrees, its "
        f"centre "
        f"within {slip.turn_m * 1e3:.1f} mm"
    )
    if calibration.pictures[1]:
        said += (
            f"; {calibration.pictures[1]} of a drive of {calibration.driven_m:.2f} m, its path within "
            f"{slip.drive_m * 1e3:.1f} mm and {math.degrees(slip.drive_rad):.2f} degrees"
        )
        if abs(calibration.curvature_pm) > 0.01:
            side = "left" if calibration.curvature_pm > 0 else "right"
            said += f", bent to the {side} with a radius of {1 / abs(calibration.curvature_pm):.0f} m"
    console.print(said + " (standard deviations)", soft_wrap=True)
    console.print(
        f"reprojection error {calibration.rms_px:.3f} px; {calibration.dropped} sightings did not fit and were left "
        f"out",
        soft_wrap=True,
    )
    if scales is not None:
        parts = [("turn", scales.turn), ("way", scales.way)]
        told = ", ".join(f"a {name} {100 * (value - 1):+.2f} %" for name, value in parts if value is not None)
        console.print(f"odometry makes {told} too long", soft_wrap=True)
    for each in calibration.not_observable:
        console.print(f"not seen: {each}", soft_wrap=True)
    for each in calibration.warnings:
        warn(each)
