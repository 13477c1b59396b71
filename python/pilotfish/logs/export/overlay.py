"""What a coordinator made of an image, drawn on it: outlines and ids of the tags; distance, bearing, status in a bar
below, so that it covers nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib import font_manager
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from pilotfish.plots.status_colours import status_colour
from pilotfish.plots.style import VERMILLION

BAR_PX = 28
_LABEL_PX = 14
_LINE_PX, _FINER = 2, 8


@dataclass(frozen=True)
class Seen:
    """What is known of one image; None: nothing is recorded."""

    t_s: float
    status: str = ""
    reason: str = ""
    distance_m: float | None = None
    bearing_rad: float | None = None
    tags: tuple[tuple[int, NDArray[np.float64]], ...] = ()  # (id, corners (4, 2) [px])


def with_overlay(pixels: NDArray[np.uint8], seen: Seen) -> NDArray[np.uint8]:
    """(H, W, 3) becomes (H' + BAR_PX, W', 3) with H', W' even, as the video's format wants it: a row or a column of the
    image is repeated at its lower or right edge, its pixels stay where they are."""
    height, width = pixels.shape[:2]
    pixels = np.pad(pixels, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
    picture = Image.new("RGB", (pixels.shape[1], pixels.shape[0] + BAR_PX), "black")
    picture.paste(Image.fromarray(pixels), (0, 0))
    for tag_id, corners_px in seen.tags:
        _draw_tag(picture, tag_id, corners_px)
    draw = ImageDraw.Draw(picture)
    font, middle = _font(_LABEL_PX), pixels.shape[0] + BAR_PX // 2
    words = f"{seen.status}: {seen.reason}" if seen.reason not in ("", "none") else seen.status or "not recorded"
    left = f"t = {seen.t_s:.2f} s"
    if seen.distance_m is not None and seen.bearing_rad is not None:
        left += f"   d = {seen.distance_m:.3f} m   θ = {math.degrees(seen.bearing_rad):+.2f}°"
    draw.text((8, middle), left, fill="white", font=font, anchor="lm")
    draw.text((picture.width - 8, middle), words, fill=status_colour(seen.status, dark=True), font=font, anchor="rm")
    return np.asarray(picture)


def _draw_tag(picture: Image.Image, tag_id: int, corners_px: NDArray[np.float64]) -> None:
    """Lines two pixels wide on the edge of the black square. Pixel centres are at integers here and there."""
    if not np.isfinite(corners_px).all() or np.abs(corners_px).max() > 1e5:
        return
    _draw_outline(picture, corners_px)
    draw = ImageDraw.Draw(picture)
    above = (float(corners_px[:, 0].mean()), float(corners_px[:, 1].min()) - 4)
    draw.text(
        above,
        f"id {tag_id}",
        fill="white",
        font=_font(_LABEL_PX),
        anchor="mb",
        stroke_width=2,
        stroke_fill="black",
    )


def _draw_outline(picture: Image.Image, corners_px: NDArray[np.float64]) -> None:
    """To fractions of a pixel: Pillow's own lines begin and end at whole ones. So it is drawn _FINER times as large,
    around the tag only, and averaged."""
    low = np.maximum(np.floor(corners_px.min(axis=0)).astype(int) - _LINE_PX, 0)
    high = np.minimum(np.ceil(corners_px.max(axis=0)).astype(int) + _LINE_PX + 1, picture.size)
    width, height = (high - low).tolist()
    if width <= 0 or height <= 0:
        return
    mask = Image.new("L", (width * _FINER, height * _FINER), 0)
    fine = np.round((corners_px - low + 0.5) * _FINER - 0.5).astype(int).tolist()
    # An odd width lies evenly on both sides.
    outline = [tuple(corner) for corner in [*fine, fine[0], fine[1]]]  # one side twice: the last joint is round, too
    ImageDraw.Draw(mask).line(outline, fill=255, width=_LINE_PX * _FINER - 1, joint="curve")
    picture.paste(VERMILLION, tuple(low.tolist()), mask.resize((width, height), Image.Resampling.BOX))


@lru_cache(maxsize=4)
def _font(size_px: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size_px)
