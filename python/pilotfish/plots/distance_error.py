"""The distance error over time, in the form of the source paper's Figs. 6 and 7, with the distance itself
below."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pilotfish.metrics import SETTLING_BAND_M, evaluate, steady_window
from pilotfish.plots.style import BLACK, FOLLOWER, SETPOINT, STANDING, style
from pilotfish.recording import Recording


def draw_distance_error(recording: Recording, title: str) -> Figure:
    """Upper axes e(t) with the steady-state error and the settling time, lower axes d(t) with d_p."""
    with style():
        figure = Figure(figsize=(7.2, 5.6))
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        draw_error_on(upper, recording)
        draw_distance_on(lower, recording)
        upper.set_title(title)
        lower.set_xlabel("time [s]")
    return figure


def draw_error_on(axes: Axes, recording: Recording) -> None:
    """e(t) with the band around the steady-state error."""
    metrics = evaluate(recording)
    time_s, steady_state_m = recording.time_s - recording.time_s[0], metrics.steady_state_error_m
    axes.axhline(0.0, color=SETPOINT, linewidth=0.8)
    axes.plot(time_s, recording.distance_error_m, color=FOLLOWER, label="$e = d_p - d$")
    band = (steady_state_m - SETTLING_BAND_M, steady_state_m + SETTLING_BAND_M)
    band_label = f"steady-state error ± {1000 * SETTLING_BAND_M:.0f} mm"
    axes.axhspan(*band, color=STANDING, alpha=0.15, linewidth=0, label=band_label)
    steady = time_s[steady_window(recording.time_s)]
    steady_label = f"steady-state error {1000 * steady_state_m:+.0f} mm"
    axes.plot(steady[[0, -1]], [steady_state_m] * 2, color=STANDING, linewidth=2.5, label=steady_label)
    if metrics.settling_time_s is not None:
        settled_label = f"settled after {metrics.settling_time_s:.1f} s"
        axes.axvline(metrics.settling_time_s, color=SETPOINT, linestyle=":", linewidth=1.2, label=settled_label)
    axes.set_ylabel("distance error e [m]")
    axes.set_xlim(0.0, time_s[-1])
    axes.legend(loc="lower right")


def draw_distance_on(axes: Axes, recording: Recording) -> None:
    """d(t), true and measured, with d_p."""
    time_s, setpoint_m = recording.time_s - recording.time_s[0], recording.meta.distance_setpoint_m
    axes.plot(time_s, recording.true_distance_m, color=FOLLOWER, label="distance d")
    if np.isfinite(recording.measured_distance_m).any():
        dots = {"color": BLACK, "markersize": 1.5, "label": "measured by the camera"}
        axes.plot(time_s, recording.measured_distance_m, ".", **dots)
    label = f"$d_p$ = {setpoint_m:.2f} m"
    axes.axhline(setpoint_m, color=SETPOINT, linestyle="--", linewidth=1.0, label=label)
    axes.set_ylabel("distance d [m]")
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(0.0, time_s[-1])
    axes.legend(loc="upper right")
