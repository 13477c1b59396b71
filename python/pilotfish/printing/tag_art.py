"""What a tag looks like: its cells, from libapriltag's own bitmap, and the white border around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.errors import UsageError
from pilotfish.printing.outline import outline
from pilotfish.printing.page import Shape
from pilotfish.vision import TagFamily


@dataclass(frozen=True)
class TagArt:
    """One tag of a family at a size: family, id, size_m (side of the black square, AprilTag's definition), border_cells
    (width of the white border around everything black), black (N, N) bool (its cells)."""

    family: str
    id: int
    size_m: float
    border_cells: float
    black: np.ndarray
    cells_at_border: int

    @property
    def cell_m(self) -> float:
        """Side of a cell."""
        return self.size_m / self.cells_at_border

    @property
    def ink_m(self) -> float:
        """Side of all that is black: size_m, or more for families with bits outside of their square."""
        return len(self.black) * self.cell_m

    @property
    def side_m(self) -> float:
        """Side of the tag with its white border."""
        return self.ink_m + 2 * self.border_cells * self.cell_m


def tag_art(family: str, tag_id: int, size_m: float, border_cells: float = 1.0) -> TagArt:
    """The tag as libapriltag draws it. ConfigError on an unknown family or an id that it does not have."""
    tags = TagFamily(family)
    try:
        bitmap = tags.bitmap(tag_id)
    except IndexError as error:
        raise UsageError(f"--ids: {error}") from error
    black = bitmap == 0
    ring = np.concatenate([black[0], black[-1], black[:, 0], black[:, -1]])
    inner = black if ring.any() else black[1:-1, 1:-1]  # the white ring of a bitmap counts as border
    return TagArt(family, tag_id, size_m, border_cells, inner, tags.cells_at_border)


def largest_size_m(family: str, border_cells: float, side_m: float, ink_m: float) -> float:
    """The largest size whose sheet has at most side_m and whose ink at most ink_m, to whole millimetres below 1 m."""
    unit = tag_art(family, 0, 1.0, border_cells)
    return float(np.floor(min(side_m / unit.side_m, ink_m / unit.ink_m) * 1e3 + 1e-6) / 1e3)


def shape_at(art: TagArt, centre_m: np.ndarray, axes: np.ndarray) -> Shape:
    """The tag on a page: centre_m (2,), axes (2, 2) whose columns are its right and its down on the page."""
    middle = len(art.black) / 2
    return Shape(tuple(centre_m + (loop - middle) * art.cell_m @ axes.T for loop in outline(art.black)))
