"""One picture of a robot's camera with what its coordinator made of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class CameraView:
    """One picture and what the coordinator made of it."""

    time_s: float
    image: NDArray[np.uint8]  # (H, W), gray
    status: str
    tags: tuple[tuple[int, NDArray[np.float64]], ...]  # (id, corners (4, 2) [px], (0, 0) the top-left pixel's centre)
    distance_m: float | None = None
    bearing_rad: float | None = None
