"""What the camera saw, as an animated GIF: the pictures with the outlines of the detected tags, d and
theta."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from matplotlib import font_manager
from PIL import Image, ImageColor, ImageDraw, ImageFont

from pilotfish.camera_view import CameraView
from pilotfish.plots.style import ORANGE, SKY, VERMILLION

MAX_BYTES = 4_000_000
WIDTH_PX = 480
FRAME_MS = 100
_BAR_PX = 30
_LABEL_PX = 14
_STATUS_COLOURS = {"tracking": SKY, "coasting": ORANGE}


def draw_camera_gif(views: Sequence[CameraView], file: str | Path, title: str = "") -> Path:
    """Writes the pictures one after the other, FRAME_MS each; fewer gray levels until it is below
    MAX_BYTES."""
    if not views:
        raise ValueError("a GIF needs at least one picture")
    pictures = [draw_view(view, title) for view in views]
    for gray_levels in (32, 16, 8):
        data = _encode(pictures, gray_levels)
        if len(data) <= MAX_BYTES:
            break
    file = Path(file)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(data)
    return file


def draw_view(view: CameraView, title: str = "") -> Image.Image:
    """One picture in colour, WIDTH_PX wide, with a bar of text above it."""
    height_px, width_px = view.image.shape
    scale = WIDTH_PX / width_px
    size = (WIDTH_PX, round(height_px * scale))
    picture = Image.new("RGB", (size[0], size[1] + _BAR_PX), "black")
    picture.paste(Image.fromarray(view.image).resize(size, Image.Resampling.BOX), (0, _BAR_PX))
    draw = ImageDraw.Draw(picture)
    for tag_id, corners_px in view.tags:
        # Pixel centres are at integers in both pictures.
        drawn = (np.asarray(corners_px) + 0.5) * scale - 0.5 + (0.0, _BAR_PX)
        outline = [tuple(corner) for corner in [*drawn.tolist(), drawn[0].tolist()]]
        draw.line(outline, fill=VERMILLION, width=2, joint="curve")
        label = f"id {tag_id}" if np.ptp(drawn[:, 0]) > 2.5 * _LABEL_PX else str(tag_id)
        above = (float(drawn[:, 0].mean()), float(drawn[:, 1].min()) - 4)
        draw.text(
            above,
            label,
            fill="white",
            font=_font(_LABEL_PX),
            anchor="mb",
            stroke_width=2,
            stroke_fill="black",
        )
    draw.text((8, 6), f"{title}   t = {view.time_s:4.1f} s".strip(), fill="white", font=_font(14))
    said = view.status
    if view.distance_m is not None and view.bearing_rad is not None:
        said = f"d = {view.distance_m:.3f} m   θ = {np.degrees(view.bearing_rad):+.1f}°   {said}"
    colour = _STATUS_COLOURS.get(view.status, "#BBBBBB")
    draw.text((WIDTH_PX - 8, 6), said, fill=colour, font=_font(14), anchor="ra")
    return picture


def _encode(pictures: Sequence[Image.Image], gray_levels: int) -> bytes:
    """One palette for all: gray levels and the few colours that are drawn. Without dithering, which does not
    compress."""
    colours = [ImageColor.getrgb(name) for name in (VERMILLION, SKY, ORANGE)]
    grays = [(int(level),) * 3 for level in np.linspace(0, 255, gray_levels)]
    palette = Image.new("P", (1, 1))
    palette.putpalette([channel for colour in [*grays, *colours] for channel in colour])
    frames = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    stream = BytesIO()
    frames[0].save(stream, "GIF", save_all=True, append_images=frames[1:], duration=FRAME_MS, loop=0, optimize=False)
    return stream.getvalue()


def _font(size_px: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size_px)
