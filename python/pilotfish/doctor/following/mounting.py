"""Whether the camera sits as ``camera.mounting`` says: by the bearing it should keep, and by how the leader stands.

Both robots stand on one floor, so the leader's upward axis, from its camera's frame through the mounting into the
robot's, must be the robot's own, and its base origin must lie at the robot's own height.
"""

from __future__ import annotations

import math

import numpy as np

from pilotfish.doctor.following.cause import Cause, risen_by
from pilotfish.doctor.following.evidence import Evidence
from pilotfish.doctor.following.setup import Setup

_BEARING_RAD = math.radians(15.0)  # more than the paper's law is off on a circle (6 degrees) or a PID (14)
_TURNS_RADPS = 0.05
_LEANS_RAD = math.radians(25.0)  # a single tag far away is measured to some 10 degrees
_HANGS_RAD = math.radians(120.0)
_OFF_FLOOR_M, _OFF_FLOOR_SHARE = 0.3, 0.15  # of the distance: 8.5 degrees of tilt
_BASE_FROM_LEVEL_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def how_it_stands(seen: Evidence, setup: Setup | None) -> list[Cause]:
    """The leader hangs or leans: the camera's roll or tilt is not what the configuration says."""
    if "leader_upside_down" in seen.reason_shares:
        return []  # what_it_sees() says it
    if risen_by(seen, "pose_upside_down"):  # while it is stopped, its counters go on
        return [upside_down("the coordinator refuses its leader, which stands on its head")]
    up = np.array(seen.sight.up_in_camera)
    if seen.sight.measured == 0 or not np.isfinite(up).all():
        return []
    known = setup is not None and setup.mounting is not None
    base_from_camera = np.array(setup.mounting.bMc) if known else None  # type: ignore[union-attr]
    rotation = base_from_camera[:3, :3] if base_from_camera is not None else _BASE_FROM_LEVEL_CAMERA
    upward = rotation @ up
    lean_rad = math.acos(max(-1.0, min(1.0, float(upward[2]))))
    told = "" if known else ", if it is mounted without roll (--config FILE says)"
    if lean_rad > _HANGS_RAD:
        lean = f"{math.degrees(lean_rad):.0f} degrees from upright{told}"
        return [upside_down(f"the leader is measured upside down ({lean})")]
    if lean_rad > _LEANS_RAD:
        return [
            Cause(
                "mounting",
                f"the leader is measured leaning by {math.degrees(lean_rad):.0f} degrees{told}: the camera's roll or "
                "tilt in camera.mounting is not what it is, or the tags' in the leader file",
                "measure camera.mounting again (pilotfish calibrate mounting); learn the body from a video "
                "(pilotfish learn-body)",
            )
        ]
    return []


def upside_down(found: str) -> Cause:
    """Left and right are exchanged; ``found``: by what it shows."""
    return Cause(
        "camera_upside_down",
        f"{found}: the camera hangs upside down, its pictures are turned by 180 degrees, or camera.mounting.roll_deg "
        "is 180 too much; left and right are exchanged",
        "camera.mounting.roll_deg: 180 for a camera that hangs upside down, 0 for one that stands (or turn the "
        "pictures in the camera's program, not both); are the leader's tags upright as its file says?",
    )


def off_the_floor(seen: Evidence, setup: Setup | None) -> list[Cause]:
    """The leader is measured above or below the floor. Heights that are all wrong by the same harm neither distance nor
    bearing: a note, where it follows."""
    if seen.sight.measured == 0 or setup is None or setup.mounting is None:
        return []
    base_from_camera = np.array(setup.mounting.bMc)
    height_m = float((base_from_camera @ np.array([*seen.sight.origin_in_camera_m, 1.0]))[2])
    distance_m = float(np.linalg.norm(seen.sight.origin_in_camera_m))
    if abs(height_m) <= max(_OFF_FLOOR_M, _OFF_FLOOR_SHARE * distance_m):
        return []
    return [
        Cause(
            "mounting",
            f"the leader is measured {abs(height_m):.2f} m {'above' if height_m > 0 else 'below'} the floor at "
            f"{distance_m:.1f} m: the camera's tilt_deg or height (position_m) in camera.mounting is not what it is, "
            "or the tags' heights in the leader file",
            "measure camera.mounting and the tags' position_m again, from the floor; on a ramp this is no fault",
        )
    ]


def bearing_that_stays(robot: str, seen: Evidence, setup: Setup | None) -> list[Cause]:
    """It tracks, and the bearing stays far from the one to keep: it cannot turn, or the camera looks elsewhere."""
    first, last, wanted = seen.sight.bearing_first_rad, seen.sight.bearing_last_rad, seen.setpoint_bearing_rad
    if not all(map(math.isfinite, (first, last, wanted))):
        return []
    off_rad, off_first_rad = (abs(math.remainder(bearing - wanted, math.tau)) for bearing in (last, first))
    if off_rad <= _BEARING_RAD or off_rad < 0.9 * off_first_rad:
        return []
    where = (
        f"it tracks, and keeps the leader at a bearing of {math.degrees(last):.0f} degrees where "
        f"{math.degrees(wanted):.0f} are wanted, no nearer than {seen.seconds:.0f} s ago"
    )
    if outside := out_of_view(setup, wanted, seen.setpoint_distance_m):
        return [Cause("mounting", f"{where}: the camera's mounting (pan_deg) does not agree: {outside}", _MEASURE_PAN)]
    at_edge = risen_by(seen, "tag_outside_frame")
    if at_edge:
        edge = f": tags of the leader were partly outside the picture {at_edge} times, at its edge it turns no further"
        return [Cause("mounting", f"{where}{edge}; the camera's mounting (pan_deg) does not agree", _MEASURE_PAN)]
    turns = seen.commanded_radps
    if not turns.count or turns.median < _TURNS_RADPS:
        return [
            Cause(
                "bearing_error",
                f"{where}, and commands no turn ({math.degrees(turns.median):.0f} degrees/s)",
                "control.limits.max_angular_radps and control.heading.gain_per_s say how it may turn; does "
                "camera.mounting.pan_deg agree with the camera?",
            )
        ]
    return [
        Cause(
            "bearing_error",
            f"{where}, although it commands {math.degrees(turns.median):.0f} degrees/s: it does not turn, or turns the "
            "other way",
            f"lift it and command a turn: do both wheels of {robot} turn, and which way (base.yaml: left and right, "
            "signs, track_width_m)? Does camera.mounting.pan_deg agree with the camera? While it passes an obstacle "
            "(control.avoidance) this is no fault",
        )
    ]


_MEASURE_PAN = (
    "measure camera.mounting.pan_deg again, positive: the camera looks left (pilotfish calibrate mounting finds it "
    "from a straight drive), or choose a setpoint.bearing_deg that the camera sees"
)


def out_of_view(setup: Setup | None, wanted_rad: float | None = None, distance_m: float | None = None) -> str:
    """That the place where the leader is to be kept, by default the configuration's, is not in the picture, with the
    angles; empty where it is, or where the configuration is not known."""
    if setup is None or setup.mounting is None or setup.camera is None or setup.setpoint is None:
        return ""
    wanted_rad = setup.setpoint.bearing_rad if wanted_rad is None else wanted_rad
    distance_m = setup.setpoint.distance_m if distance_m is None else distance_m
    base_from_camera = np.array(setup.mounting.bMc)
    camera_from_base = np.linalg.inv(base_from_camera)
    height_m = base_from_camera[2, 3]  # that it is high or low enough is a matter of the tags' place
    wanted = (distance_m * math.cos(wanted_rad), distance_m * math.sin(wanted_rad), height_m)
    in_camera = (camera_from_base @ np.array([*wanted, 1.0]))[:3]
    # Seen from a camera that is level: only how far to the side it is, whatever the tilt.
    pixel = setup.camera.project(in_camera)
    if pixel is not None and 0.0 <= pixel[0] <= setup.width - 1:
        return ""
    left, right = (_bearing(setup, base_from_camera, column) for column in (0.0, setup.width - 1.0))
    return (
        f"with it the picture covers bearings from {right:.0f} to {left:.0f} degrees, and a bearing of "
        f"{math.degrees(wanted_rad):.0f} degrees at {distance_m:.2f} m is not among them"
    )


def _bearing(setup: Setup, base_from_camera: np.ndarray, column: float) -> float:
    """Of a ray through a column in the middle row [degrees]."""
    x, y = setup.camera.normalize([column, (setup.height - 1) / 2.0])  # type: ignore[union-attr]
    ray = base_from_camera[:3, :3] @ np.array([x, y, 1.0])
    return math.degrees(math.atan2(ray[1], ray[0]))
