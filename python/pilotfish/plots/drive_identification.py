"""How well a fitted drive explains a run: own speed as seen and as fitted, and what is left."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from pilotfish.identify.fit import DriveFit
from pilotfish.plots.style import LIGHT, Theme, style

_SHOWN = 5.0  # standard deviations; what is beyond is drawn at the edge


def draw_drive_identification(fit: DriveFit, title: str, theme: Theme = LIGHT) -> Figure:
    """Two panels over time [s]: speed [m/s], and whitened residuals along and across the line of sight."""
    with style(theme):
        figure = Figure(figsize=(10, 6))
        speed, left = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        speed.plot(fit.time_s, fit.seen_speed_mps, ".", ms=2.5, color=theme.measured, label="seen by the camera")
        speed.plot(fit.time_s, fit.fitted_speed_mps, color=theme.anticipate, label="fitted: commands through the drive")
        speed.set_ylabel("own speed [m/s]")
        low, high = np.min(fit.fitted_speed_mps), np.max(fit.fitted_speed_mps)
        margin = 0.15 * (high - low) + 0.03
        speed.set_ylim(low - margin, high + margin)
        speed.set_title(
            f"{title}\nlatency {1e3 * fit.latency_s.value:.1f} ± {1e3 * fit.latency_s.sigma:.1f} ms, lag "
            f"{1e3 * fit.lag_s.value:.1f} ± {1e3 * fit.lag_s.sigma:.1f} ms, speed gain "
            f"{fit.linear_gain.value:.4f} ± {fit.linear_gain.sigma:.4f}"
        )
        speed.legend(loc="upper right")
        for values, colour, label in zip(
            fit.residuals, (theme.anticipate, theme.pid), ("along the line of sight", "across it"), strict=True
        ):
            clipped = np.clip(values, -_SHOWN, _SHOWN)
            left.plot(fit.residual_time_s, clipped, ".", ms=2.5, color=colour, label=label)
        left.set_ylim(-_SHOWN - 0.5, _SHOWN + 0.5)
        left.set_ylabel("residual [standard deviations]")
        left.set_xlabel("time [s]")
        left.legend(loc="upper right", ncols=2)
    return figure
