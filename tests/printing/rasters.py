"""Pages as a printer would put them on paper, and a ruler for them; nothing here knows how the pages were laid out."""

from __future__ import annotations

import re

import numpy as np
import pypdfium2
from typer.testing import CliRunner

from pilotfish.cli import app
from pilotfish.vision import TagDetector

DPI = 600
PIXEL_MM = 25.4 / DPI


def run(*arguments):
    """The command line; its result, and what it said without colours and line breaks."""
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    said = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    return result, re.sub(r"[\s│]+", " ", said)


def pages_of(file, dpi=DPI):
    """Every page, (H, W) uint8. The renderer stretches it to whole pixels: by 0.01 % at most at 600 dpi."""
    document = pypdfium2.PdfDocument(file)
    try:
        # Copied: the bitmap's memory ends with the document.
        return [
            document[k].render(scale=dpi / 72, grayscale=True).to_numpy().copy().squeeze() for k in range(len(document))
        ]
    finally:
        document.close()


def words_of(file):
    """The text of every page."""
    document = pypdfium2.PdfDocument(file)
    try:
        said = []
        for k in range(len(document)):
            page = document[k]
            text = page.get_textpage()
            said.append(" ".join(text.get_text_bounded().split()))
            text.close()
            page.close()
        return said
    finally:
        document.close()


def find_tags(page, family="tag36h11"):
    """{id: (4, 2) corners in mm from the paper's top left corner}, bottom left first: roughly, by libapriltag at 150
    dpi.

    Pixel centres are at whole numbers; its pixel k is the page's pixel 4 k + 2, and the paper begins at -0.5.
    """
    found = TagDetector(family).detect(np.ascontiguousarray(page[2::4, 2::4])).tags
    assert len({tag.id for tag in found}) == len(found)
    return {tag.id: (4 * tag.corners_px + 2.5) * PIXEL_MM for tag in found}


def dark_spans_mm(line):
    """(N, 2): from where to where a row or column of pixels is dark, in mm, to a fraction of a pixel.

    A pixel that an edge crosses is gray by the part of it that is black: each run of dark pixels is as long as the sum
    of their darkness, and its ends lie inside its first and last pixel by their own darkness."""
    dark = 1.0 - line.astype(float) / 255.0
    is_dark = dark > 0.02
    starts = np.flatnonzero(is_dark & ~np.r_[False, is_dark[:-1]])
    ends = np.flatnonzero(is_dark & ~np.r_[is_dark[1:], False])
    # One pixel alone has both edges in it; put them around its middle.
    spans = [
        (s + 1 - dark[s], e + dark[e]) if e > s else (s + 0.5 - dark[s] / 2, s + 0.5 + dark[s] / 2)
        for s, e in zip(starts, ends, strict=True)
    ]
    return np.array(spans).reshape(-1, 2) * PIXEL_MM


def square_mm(page, corners):
    """Left, top, right, bottom of a tag's black square [mm], measured through the outer ring of its cells. corners:
    about, upright on the page or turned by quarters."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    cell = (high - low).max() / 8
    row, column = (np.round((low + 0.5 * cell) / PIXEL_MM - 0.5).astype(int))[::-1]
    across = _holding(dark_spans_mm(page[row]), (low[0] + high[0]) / 2)
    down = _holding(dark_spans_mm(page[:, column]), (low[1] + high[1]) / 2)
    return np.array([across[0], down[0], across[1], down[1]])


def bits(page, corners, cells=8):
    """(cells, cells) bool, True where black, of a tag whose corners (bottom left first) are there."""
    bottom_left, bottom_right, top_right, top_left = corners
    share = (np.arange(cells) + 0.5) / cells
    down, right = np.meshgrid(share, share, indexing="ij")
    points = top_left + right[..., None] * (top_right - top_left) + down[..., None] * (bottom_left - top_left)
    x, y = np.moveaxis(np.round(points / PIXEL_MM - 0.5).astype(int), -1, 0)
    assert np.allclose(bottom_right - bottom_left, top_right - top_left, atol=0.2)
    return page[y, x] < 128


def ruler_mm(page):
    """Length of the ruler's bar, the longest dark run below the lowest tag."""
    lowest = page[-int(16 / PIXEL_MM) :]
    row = np.argmax((lowest < 128).sum(axis=1))
    spans = dark_spans_mm(lowest[row])
    return float(np.diff(spans, axis=1).max())


def rim(page, width_mm=4.95, dpi=DPI):
    """All pixels within that distance of the paper's edge."""
    width = int(width_mm * dpi / 25.4)
    between = page[width:-width]
    return np.concatenate(
        [part.ravel() for part in (page[:width], page[-width:], between[:, :width], between[:, -width:])]
    )


def _holding(spans, at):
    return next(span for span in spans if span[0] < at < span[1])
