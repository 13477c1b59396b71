"""Where in the picture there were corners, and how differently the board was held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from pilotfish.calibration.camera.fit import Fit
from pilotfish.calibration.camera.views import BoardView

CELLS = (8, 6)  # columns, rows over the picture
REGIONS = (
    ("upper left", "upper middle", "upper right"),
    ("left", "middle", "right"),
    ("lower left", "lower middle", "lower right"),
)
TILTED_DEG = 15.0  # from here on perspective says enough of the focal length
_SHADES = " .:-=+*#"


@dataclass(frozen=True)
class Coverage:
    """``counts`` (rows, columns): corners in each cell of the picture; ``regions`` (3, 3): the same in ninths."""

    counts: np.ndarray
    regions: np.ndarray

    @property
    def share(self) -> float:
        """Of the cells, those with a corner."""
        return float((self.counts > 0).mean())

    @property
    def empty_regions(self) -> tuple[str, ...]:
        """The ninths of the picture without any corner, by name."""
        return tuple(REGIONS[i][j] for i, j in np.argwhere(self.regions == 0))

    def text(self) -> list[str]:
        """One line a row of cells: a blank where nothing was seen, denser signs where more was."""
        highest = max(int(self.counts.max()), 1)
        steps = np.ceil(self.counts / highest * (len(_SHADES) - 1)).astype(int)
        return ["".join(_SHADES[step] * 2 for step in row) for row in steps]


@dataclass(frozen=True)
class Tilts:
    """How a board was held: ``tilts_deg`` (V,) between its normal and the optical axis, and ``directions_rad`` (V,):
    the side to which it is tilted, in the picture. It is this angle that counts, not the one with the line of sight: a
    board parallel to the picture's plane looks the same, only larger, through a longer lens, wherever it is."""

    tilts_deg: np.ndarray
    directions_rad: np.ndarray

    @property
    def tilted(self) -> int:
        """Views tilted by TILTED_DEG or more."""
        return int((self.tilts_deg >= TILTED_DEG).sum())

    @property
    def sides(self) -> tuple[str, ...]:
        """Of left/right and up/down: those about which there are tilted views."""
        directions = self.directions_rad[self.tilts_deg >= TILTED_DEG]
        flat = np.abs(np.cos(directions)) >= np.cos(np.pi / 4)
        return tuple(name for name, is_so in (("left/right", flat), ("up/down", ~flat)) if is_so.any())


def coverage_of(views: Sequence[BoardView], size: tuple[int, int]) -> Coverage:
    """Of pictures of ``size`` (width, height)."""
    pixels = np.concatenate([v.corners_px for v in views]) if views else np.zeros((0, 2))
    columns, rows = CELLS
    return Coverage(_counted(pixels, size, columns, rows), _counted(pixels, size, 3, 3))


def tilts_of(fit: Fit) -> Tilts:
    """From the poses of a fit."""
    normal = Rotation.from_rotvec(fit.rotations).as_matrix()[:, :, 2]  # away from the camera
    tilts_deg = np.degrees(np.arccos(np.clip(normal[:, 2], -1.0, 1.0)))
    return Tilts(tilts_deg, np.arctan2(normal[:, 1], normal[:, 0]))


def _counted(pixels: np.ndarray, size: tuple[int, int], columns: int, rows: int) -> np.ndarray:
    edges = [np.linspace(-0.5, side - 0.5, count + 1) for side, count in zip(size, (columns, rows), strict=True)]
    counts, *_ = np.histogram2d(pixels[:, 0], pixels[:, 1], bins=edges)
    return counts.T.astype(int)
