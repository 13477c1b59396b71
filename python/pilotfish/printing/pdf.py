"""Pages to PDF, by reportlab: vectors, true scale, the same bytes for the same pages."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pilotfish.extras import require
from pilotfish.printing.page import Line, Page, Shape, Text
from pilotfish.printing.text import FONT, printable_text
from pilotfish.whole_files import written_whole

POINT_M = 0.0254 / 72


def write_pdf(
    pages: Sequence[Page], file: str | Path, *, title: str, on_page: Callable[[int, int], None] | None = None
) -> None:
    """Writes all pages. MissingPackageError without reportlab, OSError if the file cannot be written.

    title: of the document; on_page: called with the number of pages done and of all.
    """
    with written_whole(Path(file)) as partial:
        _write_pdf(pages, partial, title, on_page)


def _write_pdf(pages: Sequence[Page], file: Path, title: str, on_page: Callable[[int, int], None] | None) -> None:
    canvas_module = require("reportlab.pdfgen.canvas", "tags")
    canvas = canvas_module.Canvas(str(file), invariant=1, pageCompression=1)
    canvas.setTitle(title)
    canvas.setCreator("pilotfish tags")
    # Viewers offer "fit to page" unless they are told not to.
    canvas.setViewerPreference("PrintScaling", "None")
    for done, page in enumerate(pages, 1):
        canvas.setPageSize((page.paper.width_m / POINT_M, page.paper.height_m / POINT_M))
        for item in page.items:
            _DRAW[type(item)](canvas, _to_points(page), item)
        canvas.showPage()
        if on_page is not None:
            on_page(done, len(pages))
    canvas.save()


_Transform = Callable[[float, float], tuple[float, float]]


def _to_points(page: Page) -> _Transform:
    """PDF counts from the bottom left corner, y up."""
    return lambda x_m, y_m: (x_m / POINT_M, (page.paper.height_m - y_m) / POINT_M)


def _draw_shape(canvas: Any, to_points: _Transform, shape: Shape) -> None:
    path = canvas.beginPath()
    for loop in shape.loops:
        path.moveTo(*to_points(*loop[0]))
        for point in loop[1:]:
            path.lineTo(*to_points(*point))
        path.close()
    canvas.setFillGray(0)
    canvas.drawPath(path, stroke=0, fill=1, fillMode=0)  # 0: even-odd


def _draw_line(canvas: Any, to_points: _Transform, line: Line) -> None:
    canvas.setLineWidth(line.width_m / POINT_M)
    canvas.setStrokeGray(line.gray)
    canvas.setDash([0.002 / POINT_M, 0.0015 / POINT_M] if line.dashed else [])
    canvas.line(*to_points(*line.start_m), *to_points(*line.end_m))


def _draw_text(canvas: Any, to_points: _Transform, text: Text) -> None:
    canvas.saveState()
    canvas.setFillGray(0)
    canvas.setFont(FONT, text.size_m / POINT_M)
    canvas.translate(*to_points(*text.at_m))
    canvas.rotate(text.turned_deg)
    draw = {"left": canvas.drawString, "middle": canvas.drawCentredString, "right": canvas.drawRightString}
    draw[text.align](0, 0, printable_text(text.text))
    canvas.restoreState()


_DRAW = {Shape: _draw_shape, Line: _draw_line, Text: _draw_text}
