"""The truth about a rehearsed camera: a calibration file, with the board's poses below."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from pilotfish.calibration.camera.calibration_file import calibration_text
from pilotfish.calibration.camera.lens import DISTORTION_NAMES
from pilotfish.calibration.camera.lens import Lens as FittedLens
from pilotfish.calibration.rehearsal.board_picture import BoardPose
from pilotfish.coordinator import load_calibration
from pilotfish.core import CameraModel, Lens
from pilotfish.errors import ConfigError
from pilotfish.files import read_text
from pilotfish.whole_files import write_whole

_MODELS = {Lens.brown_conrady: "pinhole", Lens.kannala_brandt: "fisheye"}


@dataclass(frozen=True)
class TrueCamera:
    """``camera``, and of each picture (by its name, as `pilotfish calibrate camera` says it) where the board was; empty
    for a calibration file without."""

    camera: CameraModel
    poses: dict[str, BoardPose]


def lens_of_camera(camera: CameraModel) -> FittedLens:
    """The same lens as calibrations describe it."""
    model = _MODELS[camera.lens]
    distortion = tuple(getattr(camera, name) for name in DISTORTION_NAMES[model])
    return FittedLens(model, camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, distortion)


def write_true_camera(
    file: Path, camera: CameraModel, poses: dict[str, BoardPose] | None = None, remarks: Sequence[str] = ()
) -> None:
    """A file that is read as a calibration, too. OSError if it cannot be written."""
    text = calibration_text(lens_of_camera(camera), remarks)
    if poses:
        text += "# The board's frame in the camera's: rotation vector [rad], and translation [m].\nviews:\n"
    for name, pose in (poses or {}).items():
        turn, place = (_numbers(each) for each in (Rotation.from_matrix(pose.R).as_rotvec(), pose.t_m))
        text += f'   - {{ picture: "{name}", rotation_vector: {turn}, translation_m: {place} }}\n'
    write_whole(file, text)


def read_true_camera(file: Path) -> TrueCamera:
    """Of any calibration file. ConfigError."""
    try:
        camera = load_calibration(str(file))
    except ValueError as error:
        raise ConfigError(str(error)) from error
    return TrueCamera(camera, {} if file.suffix.lower() == ".xml" else _views(file))


def _views(file: Path) -> dict[str, BoardPose]:
    # OpenCV's header is no YAML that others read, and neither are its matrices, which load_calibration has read.
    _, marked, below = read_text(file).partition("\nviews:\n")
    if not marked:
        return {}
    try:
        found = {}
        for each in yaml.safe_load(below) or []:
            turn, place = (np.array(each[key], dtype=float) for key in ("rotation_vector", "translation_m"))
            if turn.shape != (3,) or place.shape != (3,) or not np.isfinite([turn, place]).all():
                raise ValueError("three numbers are needed")
            found[str(each["picture"])] = BoardPose(Rotation.from_rotvec(turn).as_matrix(), place)
    except (yaml.YAMLError, KeyError, TypeError, ValueError, RecursionError) as error:
        said = " ".join(str(error).split())
        raise ConfigError(
            f"{file}: views: {said}; each needs picture, rotation_vector: [3 numbers], translation_m: [3 numbers]"
        ) from error
    return found


def _numbers(values: np.ndarray) -> str:
    return f"[ {', '.join(repr(float(value)) for value in values)} ]"
