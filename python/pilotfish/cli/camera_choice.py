"""Options that say through which camera pictures are rendered, and how bad they are."""

from __future__ import annotations

import math
import re
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.options import between

if TYPE_CHECKING:
    from pilotfish.core import CameraModel, CameraMounting

SHIPPED = "calibrations/sim_640x480.yaml"
DEFAULT_SIZE = "640x480"
MOST_PIXELS = 4_000_000  # every pixel is sampled nine times at once, which takes 108 bytes
_FOV_DEG = {"pinhole": (5.0, 150.0), "fisheye": (5.0, 220.0)}
_NAMES = {"pinhole": ("k1", "k2", "p1", "p2", "k3"), "fisheye": ("k1", "k2", "k3", "k4")}
CAMERA = "Whose camera"


class LensChoice(str, Enum):
    """The lens models."""

    pinhole = "pinhole"
    fisheye = "fisheye"


CameraFileOption = Annotated[
    Path | None,
    typer.Option(
        "--camera",
        exists=True,
        dir_okay=False,
        help="A calibration: OpenCV's YAML, ViSP's XML.",
        show_default="the shipped camera, 640x480, f = 600 px",
        rich_help_panel=CAMERA,
    ),
]
ConfigFileOption = Annotated[
    Path | None,
    typer.Option(
        "--config",
        exists=True,
        dir_okay=False,
        help="A coordinator's configuration: its camera, and where that sits.",
        rich_help_panel=CAMERA,
    ),
]
FovOption = Annotated[
    float | None,
    typer.Option(
        "--fov-deg",
        callback=between(5.0, 220.0, "degrees"),
        help="Or a camera that sees its picture's width under this angle; a pinhole up to 150.",
        rich_help_panel=CAMERA,
    ),
]
SizeOption = Annotated[
    str | None,
    typer.Option(
        "--size",
        help="With --fov-deg: the pictures' width and height.",
        metavar="WIDTHxHEIGHT",
        show_default=DEFAULT_SIZE,
        rich_help_panel=CAMERA,
    ),
]
LensOption = Annotated[
    LensChoice | None,
    typer.Option("--lens", help="With --fov-deg.", show_default="pinhole", rich_help_panel=CAMERA),
]
DistortionOption = Annotated[
    str | None,
    typer.Option(
        "--distortion",
        help="With --fov-deg, OpenCV's: k1,k2,p1,p2,k3 of a pinhole, k1,k2,k3,k4 of a fisheye; what is left out is 0.",
        metavar="K1,K2,...",
        show_default="none",
        rich_help_panel=CAMERA,
    ),
]
NoiseOption = Annotated[
    float,
    typer.Option("--noise", callback=between(0.0, 100.0, "gray levels"), help="Standard deviation, in gray levels."),
]
BlurOption = Annotated[
    float,
    typer.Option("--blur-px", callback=between(0.0, 20.0, "px"), help="Standard deviation of the Gaussian blur."),
]
SeedOption = Annotated[int, typer.Option("--seed", min=0, max=2**31 - 1, help="Of all that is drawn at random.")]


def chosen_camera(
    camera: Path | None,
    config: Path | None,
    fov_deg: float | None,
    size: str | None,
    lens: LensChoice | None,
    distortion: str | None,
) -> tuple[CameraModel, CameraMounting | None]:
    """The camera that the options say, and where it sits if a configuration says so. ConfigError, BadParameter."""
    given = [name for name, value in (("--camera", camera), ("--config", config), ("--fov-deg", fov_deg)) if value]
    if len(given) > 1:
        raise typer.BadParameter(f"{' and '.join(given)} exclude each other")
    described = [name for name, value in (("--size", size), ("--lens", lens), ("--distortion", distortion)) if value]
    if described and fov_deg is None:
        raise typer.BadParameter(f"{', '.join(described)}: only with --fov-deg; a file has its own")
    mounting = None
    if fov_deg is not None:
        model = _described(fov_deg, size or DEFAULT_SIZE, (lens or LensChoice.pinhole).value, distortion or "")
    elif config is not None:
        model, mounting = _configured(config)
    else:
        model = _calibrated(camera)
    if model.width * model.height > MOST_PIXELS:
        raise typer.BadParameter(
            f"pictures of {model.width}x{model.height} px are too large to be rendered: up to {MOST_PIXELS:,} pixels "
            "are allowed (2304x1728)"
        )
    return model, mounting


def _configured(file: Path) -> tuple[CameraModel, CameraMounting]:
    from pilotfish.coordinator import load_coordinator
    from pilotfish.errors import ConfigError, PilotfishError

    try:
        config = load_coordinator(str(file)).coordinator
    except PilotfishError:
        raise
    except ValueError as error:
        raise ConfigError(str(error)) from error
    return config.camera, config.mounting


def _calibrated(file: Path | None) -> CameraModel:
    from pilotfish import data
    from pilotfish.coordinator import load_calibration
    from pilotfish.errors import ConfigError, PilotfishError

    try:
        return load_calibration(str(file or data.path(SHIPPED)))
    except PilotfishError:
        raise
    except ValueError as error:
        raise ConfigError(str(error)) from error


def _described(fov_deg: float, size: str, lens: str, distortion: str) -> CameraModel:
    """The principal point is in the middle; the focal length follows from half the width, distortion included."""
    import numpy as np

    from pilotfish.calibration.rehearsal.lens import directions
    from pilotfish.core import CameraModel, Lens

    width, height = _size(size)
    low, high = _FOV_DEG[lens]
    if not low <= fov_deg <= high:
        raise typer.BadParameter(
            f"--fov-deg: {fov_deg:g} is not an angle from {low:g} to {high:g} degrees, which a {lens} lens may have"
            + ("; a wider one is --lens fisheye" if lens == "pinhole" else "")
        )
    k = dict.fromkeys(_NAMES[lens], 0.0) | dict(zip(_NAMES[lens], _numbers(distortion, lens), strict=False))
    half = math.radians(fov_deg) / 2.0
    r2 = half * half if lens == "fisheye" else math.tan(half) ** 2
    radial = (k["k1"], k["k2"], k["k3"], k.get("k4", 0.0))
    bent = math.sqrt(r2) * (1.0 + sum(each * r2 ** (i + 1) for i, each in enumerate(radial)))
    folds = typer.BadParameter(
        f"--distortion: {distortion} folds a {lens}'s view of {fov_deg:g} degrees, so that two directions come to one "
        "pixel: take smaller coefficients, or a smaller --fov-deg"
    )
    if not bent > 0.0:
        raise folds
    f_px = width / 2.0 / bent
    model = Lens.kannala_brandt if lens == "fisheye" else Lens.brown_conrady
    place = {"cx": (width - 1) / 2.0, "cy": (height - 1) / 2.0}
    camera = CameraModel(width=width, height=height, fx=f_px, fy=f_px, lens=model, **place, **k)
    # The picture's side has to be where the lens is told to look: a fold leads there from nearer to the axis, too. What
    # p1 and p2 add there is not counted.
    radially = CameraModel(
        width=width,
        height=height,
        fx=f_px,
        fy=f_px,
        lens=model,
        **place,
        **k | dict.fromkeys({"p1", "p2"} & set(k), 0.0),
    )
    x, _, z = directions(radially, np.array([radially.cx + width / 2.0, radially.cy]))
    if abs(math.atan2(x, z) - half) > 1e-3:
        raise folds
    return camera


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text)
    if not match or not all(64 <= int(side) <= 16384 for side in match.groups()):
        raise typer.BadParameter(f"--size: '{text}' is not WIDTHxHEIGHT with 64 to 16384 pixels each, as 640x480")
    return int(match[1]), int(match[2])


def _numbers(text: str, lens: str) -> list[float]:
    words = [word for word in re.split(r"[,\s]+", text.strip()) if word]
    names = _NAMES[lens]
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = [math.nan]
    if len(values) > len(names) or not all(math.isfinite(value) and abs(value) <= 100.0 for value in values):
        raise typer.BadParameter(
            f"--distortion: '{text}' is not up to {len(names)} numbers from -100 to 100 ({', '.join(names)}), as "
            "-0.3,0.1,0,0"
        )
    return values
