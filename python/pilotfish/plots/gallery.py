"""Pictures with what they show: written to a folder in one format and theme, and kept for the page of them all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from pilotfish.camera_view import CameraView
from pilotfish.plots.camera_gif import draw_camera_gif
from pilotfish.plots.style import FORMATS, LIGHT, Theme, save, to_png

MIME_TYPES = {".png": "image/png", ".svg": "image/svg+xml", ".gif": "image/gif"}


@dataclass(frozen=True)
class Picture:
    """One picture that was written."""

    file: Path
    title: str
    shows: str  # in a sentence
    content: bytes  # what a browser shows: the file itself or, of a PDF, the same as PNG
    mime_type: str


@dataclass(frozen=True)
class Gallery:
    """Where pictures go, and how they theme."""

    folder: Path
    format: str = "png"
    theme: Theme = LIGHT

    def __post_init__(self) -> None:
        if self.format not in FORMATS:
            raise ValueError(f"format '{self.format}' is not one of {', '.join(FORMATS)}")

    def save(self, figure: Figure, name: str, title: str, shows: str) -> Picture:
        """Writes ``folder/name.format``; ``figure`` was drawn with this theme."""
        file = save(figure, self.folder / f"{name}.{self.format}")
        if self.format == "pdf":
            return Picture(file, title, shows, to_png(figure), MIME_TYPES[".png"])
        return Picture(file, title, shows, file.read_bytes(), MIME_TYPES[file.suffix])

    def save_gif(self, views: Sequence[CameraView], name: str, title: str, shows: str) -> Picture:
        """Writes ``folder/name.gif``: what a camera saw. Moving pictures are GIFs in every format."""
        file = draw_camera_gif(views, self.folder / f"{name}.gif", title, self.theme)
        return Picture(file, title, shows, file.read_bytes(), MIME_TYPES[".gif"])
