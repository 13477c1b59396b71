"""A recorded run over time: what was to be kept and was not, what was commanded, how late, and what the coordinator was
doing. Several runs in the same axes, from their beginnings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from pilotfish.logs.run import RobotRun, Table
from pilotfish.logs.unseen import never_measured
from pilotfish.plots.run_lines import run_lines
from pilotfish.plots.status_band import draw_status_band, silence_style, silences, status_stretches
from pilotfish.plots.status_colours import STATUS_COLOURS
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.plots.thinned import alone, thinned
from pilotfish.plots.traces import MIN_SHOWN_MM, RMS_WINDOW_S, logarithmic_mm, running_rms
from pilotfish.recording import FloatArray, wrap_angle

Runs = Mapping[str, RobotRun]  # by what the legend says
_LINE_LETTERS = 80
_SEEN_S = 1e-3  # a status that ends within so much of the first frame is one from before it
Curve = tuple[FloatArray, FloatArray]  # time since the recording began [s], values; shapes (N,)
_PANELS: tuple[tuple[str, Callable[[RobotRun], Curve]], ...] = (
    ("distance error\ne = $d_p$ - d [mm]", lambda run: _of_frames(run, 1e3 * run.frames["error_m"])),
    (f"RMS of e [mm]\nwithin {RMS_WINDOW_S:g} s", lambda run: _of_frames(run, rms_error_mm(run.frames))),
    ("bearing error\nθ - $θ_{pd}$ [°]", lambda run: _of_frames(run, np.degrees(bearing_error_rad(run.frames)))),
    ("command:\nspeed [m/s]", lambda run: sent_speed_mps(run)),
    ("command:\nturn rate [°/s]", lambda run: sent_turn_rate_degps(run)),
    ("latency [ms]", lambda run: _of_frames(run, 1e3 * run.frames["latency_s"])),
)


def sent_speed_mps(run: RobotRun) -> Curve:
    """Every command that was sent: also the zeros between two frames, of which the frames know nothing. The frames'
    commands where a recording has no others."""
    if not len(run.commands):
        return _of_frames(run, run.frames["command_linear_mps"])
    return run.commands["t_s"], run.commands["linear_mps"]


def sent_turn_rate_degps(run: RobotRun) -> Curve:
    """The same of the turn rate [deg/s]."""
    if not len(run.commands):
        return _of_frames(run, np.degrees(run.frames["command_angular_radps"]))
    return run.commands["t_s"], np.degrees(run.commands["angular_radps"])


def _of_frames(run: RobotRun, values: FloatArray) -> Curve:
    return run.frames["t_s"], values


def bearing_error_rad(frames: Table) -> FloatArray:
    """theta - theta_pd in (-pi, pi], shape (N,); NaN where nothing was measured."""
    return wrap_angle(frames["bearing_rad"] - frames["setpoint_bearing_rad"])


def rms_error_mm(frames: Table) -> FloatArray:
    """RMS of e within RMS_WINDOW_S around each frame [mm], shape (N,), not below MIN_SHOWN_MM: for a logarithmic axis,
    where the error behind the approach is read beside that of its beginning."""
    return np.maximum(1e3 * running_rms(frames["t_s"], frames["error_m"], RMS_WINDOW_S), MIN_SHOWN_MM)


def draw_run_overview(runs: Runs, title: str = "", theme: Theme = LIGHT) -> Figure:
    """Panels one below the other, the band of the status on top. Every run has at least one frame."""
    with style(theme):
        figure = Figure(figsize=(9.0, 10.6 + 0.25 * len(runs)))
        band, *panels = figure.subplots(
            1 + len(_PANELS), 1, sharex=True, height_ratios=(0.25 + 0.25 * len(runs), 3, 2, 2, 2, 2, 2)
        )
        times = [_times(run, runs) for run in runs.values() if len(run.frames)]
        begin_s, end_s = min(t[0] for t in times), max(t[-1] for t in times)
        end_s = max(end_s, begin_s + 1e-3)
        _draw_band(band, runs, (begin_s, end_s), theme.ink)
        lines = run_lines(runs, theme)
        for axes, (label, values) in zip(panels, _PANELS, strict=True):
            if "RMS" not in label:
                axes.axhline(0.0, color=theme.ink, linewidth=0.6, alpha=0.6)
            for name, run in runs.items():
                time_s, shown = values(run)
                curve = thinned(time_s - _origin_s(run, runs), shown)
                # A command is held until the next one.
                held = "steps-post" if label.startswith("command") else "default"
                (line,) = axes.plot(*curve, **lines[name], label=name, drawstyle=held)
                dots = alone(*curve)
                if len(dots[0]):
                    axes.plot(*dots, ".", markersize=3.0, color=line.get_color())
            axes.set_ylabel(label)
        _say_what_is_not_there(panels, runs)
        panels[1].set_ylim(*_limits_mm([rms_error_mm(run.frames) for run in runs.values()]))
        logarithmic_mm(panels[1])
        panels[-1].set_ylim(bottom=0.0)
        panels[-1].set_xlabel(f"time since {'the first picture' if len(runs) > 1 else 'the recording began'} [s]")
        panels[-1].set_xlim(begin_s, end_s)
        handles = [Patch(color=colour, label=status) for status, colour in _shown(runs, end_s).items()]
        if any(silences(status_stretches(run)) for run in runs.values()):
            handles.append(Patch(label="no messages", **silence_style(theme.ink)))
        if len(runs) > 1:
            handles += panels[0].get_legend_handles_labels()[0]
        figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 5), fontsize=9)
        figure.align_ylabels(panels)
        if title:
            band.set_title(title)
    return figure


def _say_what_is_not_there(panels: Sequence[Axes], runs: Runs) -> None:
    """An axis without a curve has numbers that mean nothing: words stand there instead, with the cause in the first."""
    unseen = [text for run in runs.values() if (text := never_measured(run))]
    why = "\n".join("\n".join(wrap(text, _LINE_LETTERS)) for text in dict.fromkeys(unseen))
    for number, (axes, (_, values)) in enumerate(zip(panels, _PANELS, strict=True)):
        if any(np.isfinite(values(run)[1]).any() for run in runs.values()):
            continue
        axes.tick_params(axis="y", which="both", left=False, labelleft=False)
        axes.grid(visible=False)
        for line in axes.get_lines():  # the zero, which would run through the words
            line.set_visible(False)
        words = why if number == 0 and why else "never measured"
        axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", va="center", fontsize=10)


def _limits_mm(curves: list[FloatArray]) -> tuple[float, float]:
    """Of a logarithmic axis, a little beyond the values; an axis all the same where nothing was measured."""
    known = np.concatenate(curves)
    known = known[np.isfinite(known)]
    return (float(known.min()) / 1.5, float(known.max()) * 1.5) if known.size else (1.0, 1000.0)


def _origin_s(run: RobotRun, runs: Runs) -> float:
    """Runs that are compared begin together, at their first frames; a single one has the times of its events."""
    return float(run.frames["t_s"][0]) if len(runs) > 1 else 0.0


def _times(run: RobotRun, runs: Runs) -> FloatArray:
    return run.frames["t_s"] - _origin_s(run, runs)


def _draw_band(axes: Axes, runs: Runs, span_s: tuple[float, float], ink: str) -> None:
    for row, run in enumerate(runs.values()):
        origin_s = _origin_s(run, runs)
        stretches = [(from_s - origin_s, to_s - origin_s, status) for from_s, to_s, status in status_stretches(run)]
        draw_status_band(axes, stretches, -row, 0.8, span_s, ink)
    names = list(runs) if len(runs) > 1 else ["status"]
    axes.set_yticks([-row for row in range(len(runs))], names)
    axes.set_ylim(-len(runs) + 0.4, 0.6)
    axes.grid(visible=False)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def _shown(runs: Runs, end_s: float) -> dict[str, str]:
    """The statuses that occur between the first frame and the last, in the order of the protocol."""
    there = set()
    for run in runs.values():
        begin_s = float(run.frames["t_s"][0])
        there |= {
            status
            for from_s, to_s, status in status_stretches(run)
            if to_s > begin_s + _SEEN_S and from_s - _origin_s(run, runs) < end_s
        }
    return {status: colour for status, colour in STATUS_COLOURS.items() if status in there}
