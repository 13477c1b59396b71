"""What several laws did, over time: one function draws one quantity of all of them on an axes, with its label."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter, StrMethodFormatter

from pilotfish.plots.laws import law_styles
from pilotfish.plots.style import LIGHT, Theme
from pilotfish.recording import FloatArray, Recording

RMS_WINDOW_S = 0.5
MIN_SHOWN_MM = 1e-3  # nothing smaller is drawn on the logarithmic axis

Runs = Mapping[str, Recording]  # by the name of the law


def draw_errors_on(axes: Axes, runs: Runs, theme: Theme = LIGHT) -> None:
    """e(t) = d_p - d(t) of every law [m]."""
    _draw(axes, runs, theme, lambda run: run.distance_error_m, zero=True)
    axes.set_ylabel("distance error e [m]")


def draw_rms_on(axes: Axes, runs: Runs, theme: Theme = LIGHT) -> None:
    """RMS of e within RMS_WINDOW_S around each moment [mm], on a logarithmic axis: a law that keeps the distance to
    0.1 mm is seen beside one that keeps it to 100 mm."""

    def rms_mm(run: Recording) -> FloatArray:
        return np.maximum(1000.0 * running_rms(run.time_s, run.distance_error_m, RMS_WINDOW_S), MIN_SHOWN_MM)

    _draw(axes, runs, theme, rms_mm)
    logarithmic_mm(axes)
    axes.set_ylabel(f"RMS of e [mm]\nwithin {RMS_WINDOW_S:g} s")


def logarithmic_mm(axes: Axes) -> None:
    """A logarithmic axis of y with plain numbers: 0.01, 0.1, 1, 10."""
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=9))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def draw_bearings_on(axes: Axes, runs: Runs, theme: Theme = LIGHT) -> None:
    """theta(t) - theta_pd of every law [deg]."""
    _draw(axes, runs, theme, lambda run: np.degrees(run.bearing_error_rad), zero=True)
    axes.set_ylabel("bearing error [°]")


def draw_speeds_on(axes: Axes, runs: Runs, theme: Theme = LIGHT) -> None:
    """The commanded speed of every law [m/s]."""
    _draw(axes, runs, theme, lambda run: run.command_linear_mps, zero=True)
    axes.set_ylabel("command:\nspeed [m/s]")


def draw_turn_rates_on(axes: Axes, runs: Runs, theme: Theme = LIGHT) -> None:
    """The commanded turn rate of every law [deg/s]."""
    _draw(axes, runs, theme, lambda run: np.degrees(run.command_angular_radps), zero=True)
    axes.set_ylabel("command:\nturn rate [°/s]")


def running_rms(time_s: FloatArray, values: FloatArray, window_s: float) -> FloatArray:
    """sqrt(mean(x^2)) over the samples within window_s / 2 of each, shape (N,); at the ends over those there are. NaN
    where the value is, and values that are NaN count nothing."""
    if not len(values):
        return np.zeros(0)
    first = np.searchsorted(time_s, time_s - 0.5 * window_s - 1e-9)
    last = np.searchsorted(time_s, time_s + 0.5 * window_s + 1e-9)
    known = np.isfinite(values)
    bounds = np.stack([first, last], axis=1).ravel()  # sums of [first, last), one after the other

    def sums(of: FloatArray) -> FloatArray:
        return np.add.reduceat(np.append(of, 0.0), bounds)[::2]

    squares, counts = sums(np.where(known, np.square(values), 0.0)), sums(known.astype(float))
    return np.where(known, np.sqrt(squares / np.maximum(counts, 1.0)), np.nan)


def _draw(
    axes: Axes, runs: Runs, theme: Theme, quantity: Callable[[Recording], FloatArray], *, zero: bool = False
) -> None:
    if zero:
        axes.axhline(0.0, color=theme.guide, linewidth=0.8)
    styles = law_styles(runs, theme)
    for law, run in runs.items():
        axes.plot(run.time_s - run.time_s[0], quantity(run), **styles[law].line())
    limit_time(axes, max(run.time_s[-1] - run.time_s[0] for run in runs.values()))


def limit_time(axes: Axes, duration_s: float) -> None:
    """From 0 to the next tenth of a second, so that a run of 19.97 s ends at a tick that says 20."""
    axes.set_xlim(0.0, np.ceil(10.0 * duration_s) / 10.0)
    axes.xaxis.set_major_locator(MaxNLocator(steps=(1, 2, 5, 10)))
