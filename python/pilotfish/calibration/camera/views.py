"""What pictures show of a board, and why some of them are not used."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class BoardView:
    """The corners of a board in one picture.

    ``name``: of the picture; ``ids`` (P,): place in ``Board.corners_m()``; ``points_m`` (P, 3) in the board's frame;
    ``corners_px`` (P, 2), (0, 0) the centre of the top left pixel; ``blur_px``: standard deviation of the blur across
    the more blurred of the two directions of edges; ``marker_share``: a marker's measured side as a part of a
    square's, None if none were seen.
    """

    name: str
    ids: np.ndarray
    points_m: np.ndarray
    corners_px: np.ndarray
    blur_px: float = 0.0
    marker_share: float | None = None

    def __len__(self) -> int:
        return len(self.ids)

    def where(self, kept: np.ndarray) -> BoardView:
        """The same view with the corners for which ``kept`` (P,) holds."""
        return BoardView(
            self.name, self.ids[kept], self.points_m[kept], self.corners_px[kept], self.blur_px, self.marker_share
        )


@dataclass(frozen=True)
class Rejected:
    """A picture that is not used: ``why`` is one of the words below, ``detail`` says it in full."""

    name: str
    why: str
    detail: str


# The kinds of rejection, in the order in which they are looked for.
UNREADABLE, NO_BOARD, OTHER_BOARD, MIRRORED = "unreadable", "no board", "another board", "mirrored"
FEW_CORNERS, BLURRED, OUTLIER, REDUNDANT = "too few corners", "blurred", "outlier", "redundant"
