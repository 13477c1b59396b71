"""A lens as the file that Pilotfish reads: OpenCV's calibration YAML."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pilotfish.calibration.camera.lens import Lens
from pilotfish.coordinator import load_calibration
from pilotfish.core import CameraModel
from pilotfish.errors import ConfigError
from pilotfish.whole_files import write_whole

# As ROS's camera_info calls them; a file without the key is a plumb_bob's.
DISTORTION_MODEL = {"pinhole": "plumb_bob", "fisheye": "equidistant"}
AGREE_PX = 1e-6


def calibration_text(lens: Lens, remarks: Sequence[str] = ()) -> str:
    """The file's text, every number with all its digits, ``remarks`` as comments above."""
    matrix = ", ".join(repr(float(value)) for value in lens.matrix.ravel())
    distortion = ", ".join(repr(float(value)) for value in lens.distortion)
    lines = [
        "%YAML:1.0",
        "---",
        *(f"# {line}".rstrip() for line in remarks),
        f"image_width: {lens.width}",
        f"image_height: {lens.height}",
        f"distortion_model: {DISTORTION_MODEL[lens.model]}",
        *("camera_matrix: !!opencv-matrix", "   rows: 3", "   cols: 3", "   dt: d", f"   data: [ {matrix} ]"),
        *("distortion_coefficients: !!opencv-matrix", "   rows: 1", f"   cols: {len(lens.distortion)}", "   dt: d"),
        f"   data: [ {distortion} ]",
    ]
    return "\n".join(lines) + "\n"


def check_readable(lens: Lens) -> CameraModel:
    """What this installation's reader makes of the lens. ConfigError if it refuses the file, or would see through it
    differently: compared are pixels of points all over the picture."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "camera.yaml"
        file.write_text(calibration_text(lens))
        try:
            model = load_calibration(str(file))
        except ValueError as error:
            said = str(error).replace(f" (in {file})", "")
            raise ConfigError(
                f"Pilotfish cannot read a {lens.model} lens like this one: {said}. Without --out there is the report "
                f"alone"
            ) from error
    x, y = np.meshgrid(np.linspace(-0.8, 0.8, 9), np.linspace(-0.8, 0.8, 9))
    half = np.array([lens.width / (2 * lens.fx), lens.height / (2 * lens.fy)])
    points = np.stack([x.ravel() * half[0], y.ravel() * half[1], np.ones(x.size)], axis=-1)
    theirs = np.array([model.project(point) for point in points])
    apart = np.abs(theirs - lens.project(points, np.zeros(3), np.zeros(3))).max()
    if not apart < AGREE_PX:
        raise ConfigError(
            f"Pilotfish reads this {lens.model} lens differently ({apart:.3g} px apart): no file is written that "
            f"misleads"
        )
    return model


def write_calibration(file: Path, lens: Lens, remarks: Sequence[str] = ()) -> CameraModel:
    """Writes the file, after check_readable; what the reader makes of it. OSError if it cannot be written."""
    model = check_readable(lens)
    write_whole(file, calibration_text(lens, remarks))
    return model
