"""One run over time: the distance error in the form of the source paper's Figs. 6 and 7, the same magnified, the
bearing error and the command."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pilotfish.metrics import SETTLING_BAND_M, evaluate, steady_window
from pilotfish.number_text import millimetres
from pilotfish.plots.laws import LawStyle, law_styles
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.plots.traces import limit_time
from pilotfish.recording import FloatArray, Recording

MIN_MAGNIFIED_MM = 0.2  # height of the magnified axes, at least
TITLE_LETTERS = 62  # as many as the figure is wide


def draw_distance_error(recording: Recording, title: str, theme: Theme = LIGHT) -> Figure:
    """From above: e(t) with the steady-state error and the settling time, and on the right the distance that it is;
    e(t) in millimetres near the steady state; the bearing error; the commanded speed and turn rate."""
    with style(theme):
        figure = Figure(figsize=(7.2, 9.0))
        error, magnified, bearing, speed, turn = figure.subplots(5, 1, sharex=True, height_ratios=(3, 2, 2, 1.5, 1.5))
        error.set_title(textwrap.fill(title, TITLE_LETTERS))
        draw_error_on(error, recording, theme)
        _draw_magnified_on(magnified, recording, theme)
        _draw_bearing_on(bearing, recording, theme)
        _draw_command_on(speed, turn, recording, theme)
        turn.set_xlabel("time [s]")
        limit_time(turn, recording.time_s[-1] - recording.time_s[0])
        figure.align_ylabels()
    return figure


def draw_error_on(axes: Axes, recording: Recording, theme: Theme = LIGHT) -> None:
    """e(t) with the band around the steady-state error."""
    metrics = evaluate(recording)
    time_s, steady_state_m = _elapsed_s(recording), metrics.steady_state_error_m
    band = (steady_state_m - SETTLING_BAND_M, steady_state_m + SETTLING_BAND_M)
    band_label = f"steady-state error ± {1000 * SETTLING_BAND_M:.0f} mm"
    axes.axhspan(*band, color=theme.guide, alpha=0.18, linewidth=0, label=band_label)
    axes.axhline(0.0, color=theme.guide, linewidth=0.8)
    axes.plot(time_s, recording.distance_error_m, **_own_line(recording, theme, label="$e = d_p - d$, true"))
    steady = time_s[steady_window(recording.time_s)]
    steady_label = f"steady-state error {millimetres(steady_state_m)}"
    steady_line = {"color": theme.guide, "linewidth": 1.4, "linestyle": "--", "zorder": 3.0}
    axes.plot(steady[[0, -1]], [steady_state_m] * 2, label=steady_label, **steady_line)
    if metrics.settling_time_s is not None:
        settled_label = f"settled after {metrics.settling_time_s:.1f} s"
        axes.axvline(metrics.settling_time_s, color=theme.guide, linestyle=":", linewidth=1.4, label=settled_label)
    axes.set_ylabel("distance error e [m]")
    axes.legend(loc="lower right")
    setpoint_m = recording.meta.distance_setpoint_m
    opposite = (lambda error_m: setpoint_m - error_m, lambda distance_m: setpoint_m - distance_m)
    axes.secondary_yaxis("right", functions=opposite).set_ylabel("distance d [m]")


def _draw_magnified_on(axes: Axes, recording: Recording, theme: Theme) -> None:
    """e(t) and d_p minus the measured distance [mm], as far as they come to the steady state."""
    time_s, error_mm = _elapsed_s(recording), 1000.0 * recording.distance_error_m
    measured_mm = 1000.0 * (recording.meta.distance_setpoint_m - recording.measured_distance_m)
    axes.axhline(0.0, color=theme.guide, linewidth=0.8)
    _draw_measured_on(axes, time_s, measured_mm, theme)
    axes.plot(time_s, error_mm, **_own_line(recording, theme, label="true"))
    axes.set_ylim(*_range_near_the_end(recording, error_mm, measured_mm))
    axes.set_ylabel("e, magnified\n[mm]")
    axes.legend(loc="lower right", ncols=2, markerscale=3.0)


def _draw_bearing_on(axes: Axes, recording: Recording, theme: Theme) -> None:
    time_s, error_deg = _elapsed_s(recording), np.degrees(recording.bearing_error_rad)
    measured_deg = np.degrees(recording.measured_bearing_rad - recording.meta.bearing_setpoint_rad)
    axes.axhline(0.0, color=theme.guide, linewidth=0.8)
    _draw_measured_on(axes, time_s, measured_deg, theme)
    axes.plot(time_s, error_deg, **_own_line(recording, theme, label="true"))
    axes.set_ylabel("bearing error\n[°]")
    axes.legend(loc="best", ncols=2, markerscale=3.0)


def _draw_command_on(speed: Axes, turn: Axes, recording: Recording, theme: Theme) -> None:
    time_s = _elapsed_s(recording)
    for axes, command in (
        (speed, recording.command_linear_mps),
        (turn, np.degrees(recording.command_angular_radps)),
    ):
        axes.axhline(0.0, color=theme.guide, linewidth=0.8)
        axes.plot(time_s, command, **_own_line(recording, theme, label="command"))
    leader = {"color": theme.ink, "linewidth": 1.0, "linestyle": "--", "label": "the leader's speed"}
    speed.plot(time_s, recording.leader_linear_mps, **leader)
    speed.set_ylabel("speed [m/s]")
    speed.legend(loc="best", ncols=2)
    turn.set_ylabel("turn rate [°/s]")
    turn.legend(loc="best")


def _own_line(recording: Recording, theme: Theme, **changes: object) -> dict[str, object]:
    """The line of the law that drove, undashed: there is no other law to tell it from."""
    own: LawStyle = law_styles([recording.meta.profile], theme)[recording.meta.profile]
    return own.line(linestyle="-", linewidth=1.8, **changes)


def _draw_measured_on(axes: Axes, time_s: FloatArray, measured: FloatArray, theme: Theme) -> None:
    """Dots behind the true curve, if anything was measured."""
    if np.isfinite(measured).any():
        dots = {"color": theme.measured, "marker": ".", "markersize": 3.0, "markeredgewidth": 0, "linestyle": "none"}
        axes.plot(time_s, measured, label="measured by the camera", zorder=1.9, **dots)


def _range_near_the_end(recording: Recording, *values_mm: FloatArray) -> tuple[float, float]:
    """What the values span within the second half of the run, with a margin of a half on either side."""
    late = recording.time_s >= 0.5 * (recording.time_s[0] + recording.time_s[-1])
    finite = np.concatenate([values[late & np.isfinite(values)] for values in values_mm])
    low, high = float(finite.min()), float(finite.max())
    margin = max(0.5 * (high - low), 0.5 * (MIN_MAGNIFIED_MM - (high - low)))
    return low - margin, high + margin


def _elapsed_s(recording: Recording) -> FloatArray:
    return recording.time_s - recording.time_s[0]
