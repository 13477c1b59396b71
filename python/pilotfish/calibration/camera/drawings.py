"""What a calibration looks like: where the corners were, what is left of them, and what the lens does."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pilotfish.calibration.camera.calibrate import CameraCalibration
from pilotfish.calibration.camera.lens import Lens
from pilotfish.plots.style import BLUE, SETPOINT, VERMILLION, save, style

ARROW_SHARE = 0.04  # of the picture's width: how long the residuals' 95th percentile is drawn
_WIDTH_IN = 7.2


def save_drawings(calibration: CameraCalibration, folder: Path) -> list[Path]:
    """coverage.png, residuals.png and distortion.png in ``folder``."""
    return [
        save(draw_coverage(calibration), folder / "coverage.png"),
        save(draw_residuals(calibration), folder / "residuals.png"),
        save(draw_distortion(calibration.lens), folder / "distortion.png"),
    ]


def draw_coverage(calibration: CameraCalibration) -> Figure:
    """All corners that were used, over the cells that the coverage counts."""
    lens, coverage = calibration.lens, calibration.coverage
    with style():
        figure, axes = _picture(lens)
        rows, columns = coverage.counts.shape
        extent = (-0.5, lens.width - 0.5, lens.height - 0.5, -0.5)
        shown = axes.imshow(coverage.counts, extent=extent, cmap="Blues", vmin=0, aspect="equal")
        axes.set_xticks(np.linspace(0, lens.width, columns + 1).round())
        axes.set_yticks(np.linspace(0, lens.height, rows + 1).round())
        pixels = np.concatenate([v.corners_px for v in calibration.views])
        axes.plot(pixels[:, 0], pixels[:, 1], ".", color=VERMILLION, markersize=2)
        figure.colorbar(shown, ax=axes, label="corners in the cell", shrink=0.8)
        axes.set_title(f"{len(pixels)} corners of {len(calibration.views)} views: {coverage.share:.0%} of the cells")
    return figure


def draw_residuals(calibration: CameraCalibration) -> Figure:
    """What the lens leaves unexplained of each corner, enlarged: random arrows are noise, a pattern is the lens."""
    lens, fit = calibration.lens, calibration.fit
    with style():
        figure, axes = _picture(lens)
        pixels = np.concatenate([v.corners_px for v in calibration.views])
        residuals = np.concatenate(fit.residuals_px)
        typical_px = max(float(np.percentile(np.linalg.norm(residuals, axis=1), 95)), 1e-9)
        enlarged = ARROW_SHARE * lens.width / typical_px
        drawn = {"angles": "xy", "scale_units": "xy", "scale": 1.0 / enlarged, "color": BLUE, "width": 0.0015}
        axes.quiver(pixels[:, 0], pixels[:, 1], residuals[:, 0], residuals[:, 1], **drawn)
        axes.set_title(
            f"residuals, {enlarged:.0f} times enlarged: {fit.rms_px:.3f} px RMS, 95 % below {typical_px:.3f} px"
        )
    return figure


def draw_distortion(lens: Lens) -> Figure:
    """How far the lens moves each pixel from where a pinhole of the same focal length would have it."""
    with style():
        figure, axes = _picture(lens)
        u, v = np.meshgrid(np.linspace(0, lens.width - 1, 65), np.linspace(0, lens.height - 1, 49))
        straight = np.stack([(u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, np.ones_like(u)], axis=-1)
        seen = lens.project(straight.reshape(-1, 3), np.zeros(3), np.zeros(3)).reshape(*u.shape, 2)
        shift = seen - np.stack([u, v], axis=-1)
        length = np.linalg.norm(shift, axis=-1)
        filled = axes.contourf(u, v, length, levels=12, cmap="Blues")
        figure.colorbar(filled, ax=axes, label="moved by [px]", shrink=0.8)
        some = (slice(None, None, 6), slice(None, None, 6))
        drawn = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "color": VERMILLION, "width": 0.002}
        axes.quiver(u[some], v[some], shift[some][..., 0], shift[some][..., 1], **drawn)
        axes.plot(lens.cx, lens.cy, "+", color=SETPOINT, markersize=14, markeredgewidth=2)
        axes.set_title(f"distortion: up to {length.max():.1f} px (+: principal point; arrows true to scale)")
    return figure


def _picture(lens: Lens) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(_WIDTH_IN, _WIDTH_IN * lens.height / lens.width * 0.92))
    axes = figure.subplots()
    axes.set_xlim(-0.5, lens.width - 0.5)
    axes.set_ylim(lens.height - 0.5, -0.5)
    axes.set_aspect("equal")
    axes.set_xlabel("u [px]")
    axes.set_ylabel("v [px]")
    return figure, axes
