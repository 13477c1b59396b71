"""What a calibration found beside the truth, and whether it is near enough."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from pilotfish.calibration.board import Board
from pilotfish.calibration.camera import CameraCalibration
from pilotfish.calibration.rehearsal.lens import directions
from pilotfish.calibration.rehearsal.lens import project as project_truly
from pilotfish.calibration.rehearsal.true_camera import TrueCamera, lens_of_camera
from pilotfish.core import CameraModel, CameraMounting, LeaderBody
from pilotfish.errors import ConfigError

FOCAL_PERCENT = 0.05
CENTRE_PX = 0.5
PLACE_MM = 2.0
TURN_DEG = 0.1
_GRID = (17, 13)  # of the points all over the picture at which two lenses are compared


@dataclass(frozen=True)
class Difference:
    """One number: ``found`` and ``true`` in ``unit``, ``off`` in ``off_unit`` (found minus true, or a distance), and
    how much of that is ``allowed``; None: it is only shown."""

    name: str
    found: float | None
    true: float | None
    unit: str
    off: float
    off_unit: str
    allowed: float | None

    @property
    def agrees(self) -> bool:
        """Within what is allowed; nothing that is not a number is."""
        return self.allowed is None or abs(self.off) <= self.allowed


def check_comparable(truth: TrueCamera, size: tuple[int, int], model: str) -> None:
    """ConfigError if the truth is of pictures of another size (width, height), or another lens model."""
    true = lens_of_camera(truth.camera)
    if size != (true.width, true.height):
        raise ConfigError(
            f"the truth is of a camera with {true.width}x{true.height} px, the pictures have {size[0]}x{size[1]} px: "
            "is it that of these pictures?"
        )
    if model != true.model:
        raise ConfigError(f"the truth is a {true.model} lens: add --model {true.model}")


def camera_differences(
    found: CameraModel, truth: TrueCamera, middles_c: dict[str, np.ndarray] | None = None, board: Board | None = None
) -> list[Difference]:
    """Of a camera; and of where the middle of the ``board`` was, (3,) [m] in the camera's frame by the picture's name
    (a chessboard's corners may be counted from either end; its middle is the same). ConfigError if the truth is of
    another size or lens model."""
    true = truth.camera
    check_comparable(truth, (found.width, found.height), lens_of_camera(found).model)
    rows = []
    for name in ("fx", "fy"):
        value, wanted = getattr(found, name), getattr(true, name)
        rows.append(Difference(name, value, wanted, "px", 100.0 * (value / wanted - 1.0), "%", FOCAL_PERCENT))
    for name in ("cx", "cy"):
        value, wanted = getattr(found, name), getattr(true, name)
        rows.append(Difference(name, value, wanted, "px", value - wanted, "px", CENTRE_PX))
    rows.append(Difference("lens, RMS", None, None, "", lens_rms_px(found, true), "px", None))
    common = sorted(set(middles_c or {}) & set(truth.poses)) if board else []
    if common:
        middle = np.array([*board.size_m, 0.0]) / 2.0
        true_middles = np.array([pose.R @ middle + pose.t_m for pose in (truth.poses[name] for name in common)])
        off_m = np.array([middles_c[name] for name in common]) - true_middles
        rms_mm = 1e3 * math.sqrt(float((off_m**2).sum(axis=1).mean()))
        rows.append(Difference("board's place, RMS", None, None, "", rms_mm, "mm", None))
    return rows


def board_middles(calibration: CameraCalibration, board: Board) -> dict[str, np.ndarray]:
    """Where a calibration found the board's middle, (3,) [m] in the camera's frame, by the picture's name."""
    middle, fit = np.array([*board.size_m, 0.0]) / 2.0, calibration.fit
    places = Rotation.from_rotvec(fit.rotations).apply(middle) + fit.translations_m
    return {view.name: place for view, place in zip(calibration.views, places, strict=True)}


def lens_rms_px(found: CameraModel, true: CameraModel) -> float:
    """Over a grid of pixels: from where each is lit by the true lens to where the found one sees that direction. A
    turn of the camera that another principal point imitates is part of it."""
    u, v = np.meshgrid(np.linspace(0, true.width - 1, _GRID[0]), np.linspace(0, true.height - 1, _GRID[1]))
    pixels = np.stack([u, v], axis=-1).reshape(-1, 2)
    off = project_truly(found, directions(true, pixels)) - pixels
    return math.sqrt(float((off**2).sum(axis=1).mean()))


def mounting_differences(found: CameraMounting, sigma: Sequence[float], true: CameraMounting) -> list[Difference]:
    """Of the six numbers; those with an infinite ``sigma`` (6,) were not observed and are left out."""
    rows = []
    for k, name in enumerate(("forward", "left", "up")):
        value, wanted = 1e3 * found.position_m[k], 1e3 * true.position_m[k]
        rows.append(Difference(name, value, wanted, "mm", value - wanted, "mm", PLACE_MM))
    for name in ("pan", "tilt", "roll"):
        value, wanted = (math.degrees(getattr(each, f"{name}_rad")) for each in (found, true))
        off = math.remainder(value - wanted, 360.0)
        rows.append(Difference(name, value, wanted, "°", off, "°", TURN_DEG))
    return [row for row, s in zip(rows, sigma, strict=True) if np.isfinite(s)]


def body_differences(found: LeaderBody, true: LeaderBody) -> list[Difference]:
    """Of each tag: the distance between its centres, and the angle between its directions. ConfigError if the truth has
    none of the tags, or others of them."""
    known = {tag.id: tag for tag in true.tags}
    ids = sorted(tag.id for tag in found.tags)
    if ids != sorted(known):
        raise ConfigError(f"the truth has the tags {sorted(known)}, seen were {ids}: is it that of these pictures?")
    if found.family != true.family:
        raise ConfigError(f"the truth has tags of {true.family}, looked for was {found.family}: add --family")
    rows = []
    for tag in sorted(found.tags, key=lambda tag: tag.id):
        apart = np.linalg.inv(known[tag.id].oMt) @ tag.oMt
        place_mm = 1e3 * float(np.linalg.norm(apart[:3, 3]))
        # The angle of a turn from its sine and its cosine: exact near 0, where the trace alone is not.
        axial = (apart[[2, 0, 1], [1, 2, 0]] - apart[[1, 2, 0], [2, 0, 1]]) / 2.0
        turn_deg = math.degrees(math.atan2(float(np.linalg.norm(axial)), (float(np.trace(apart[:3, :3])) - 1.0) / 2.0))
        rows.append(Difference(f"tag {tag.id}, place", None, None, "", place_mm, "mm", PLACE_MM))
        rows.append(Difference(f"tag {tag.id}, turn", None, None, "", turn_deg, "°", TURN_DEG))
    return rows
