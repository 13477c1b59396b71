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
from pilotfish.number_text import signed
from pilotfish.plots.style import LIGHT, Theme
from pilotfish.whole_files import written_whole

MAX_BYTES = 4_000_000
WIDTH_PX = 480
FRAME_MS = 100
_BAR_PX = 30
_LABEL_PX = 14
_BAR_TEXT_PX = 14
_MARGIN_PX = 8


def draw_camera_gif(views: Sequence[CameraView], file: str | Path, title: str = "", theme: Theme = LIGHT) -> Path:
    """Writes the pictures one after the other, FRAME_MS each; fewer gray levels until it is below
    MAX_BYTES."""
    if not views:
        raise ValueError("a GIF needs at least one picture")
    pictures = [draw_view(view, title, theme) for view in views]
    for gray_levels in (32, 16, 8):
        data = _encode(pictures, gray_levels, theme)
        if len(data) <= MAX_BYTES:
            break
    file = Path(file)
    with written_whole(file) as partial:
        partial.write_bytes(data)
    return file


def draw_view(view: CameraView, title: str = "", theme: Theme = LIGHT) -> Image.Image:
    """One picture in colour, WIDTH_PX wide, with a bar of text above it."""
    seen = draw_seen(view, theme)
    picture = Image.new("RGB", (seen.width, seen.height + _BAR_PX), theme.ground)
    picture.paste(seen, (0, _BAR_PX))
    _draw_bar(ImageDraw.Draw(picture), view, title, theme)
    return picture


def draw_seen(view: CameraView, theme: Theme = LIGHT) -> Image.Image:
    """The same without the bar."""
    height_px, width_px = view.image.shape
    scale = WIDTH_PX / width_px
    size = (WIDTH_PX, round(height_px * scale))
    picture = Image.fromarray(view.image).resize(size, Image.Resampling.BOX).convert("RGB")
    draw = ImageDraw.Draw(picture)
    for tag_id, corners_px in view.tags:
        # Pixel centres are at integers in both pictures.
        drawn = (np.asarray(corners_px) + 0.5) * scale - 0.5
        outline = [tuple(corner) for corner in [*drawn.tolist(), drawn[0].tolist()]]
        draw.line(outline, fill=theme.measured, width=2, joint="curve")
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
    return picture


def measured_texts(view: CameraView) -> list[str]:
    """The measured distance and bearing, as "d = 1.100 m" and "θ = -10.0°"; nothing if nothing was measured."""
    if view.distance_m is None or view.bearing_rad is None:
        return []
    return [f"d = {view.distance_m:.3f} m", f"θ = {signed(float(np.degrees(view.bearing_rad)), 1)}°"]


def _draw_bar(draw: ImageDraw.ImageDraw, view: CameraView, title: str, theme: Theme) -> None:
    """Time and status, what was measured and, where it fits, the title."""
    font = _font(_BAR_TEXT_PX)
    said = "   ".join([*measured_texts(view), view.status])
    draw.text((WIDTH_PX - _MARGIN_PX, 6), said, fill=theme.ink, font=font, anchor="ra")
    time = f"t = {view.time_s:4.1f} s"
    room_px = WIDTH_PX - 4 * _MARGIN_PX - font.getlength(said)
    whole = f"{title}   {time}".strip()
    draw.text((_MARGIN_PX, 6), whole if font.getlength(whole) <= room_px else time, fill=theme.ink, font=font)


def _encode(pictures: Sequence[Image.Image], gray_levels: int, theme: Theme) -> bytes:
    """One palette for all: gray levels and the few colours that are drawn. Without dithering, which does not
    compress."""
    colours = [ImageColor.getrgb(name) for name in (theme.measured, theme.ink, theme.ground)]
    grays = [(int(level),) * 3 for level in np.linspace(0, 255, gray_levels)]
    palette = Image.new("P", (1, 1))
    palette.putpalette([channel for colour in [*grays, *colours] for channel in colour])
    frames = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    stream = BytesIO()
    frames[0].save(stream, "GIF", save_all=True, append_images=frames[1:], duration=FRAME_MS, loop=0, optimize=False)
    return stream.getvalue()


def _font(size_px: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size_px)
