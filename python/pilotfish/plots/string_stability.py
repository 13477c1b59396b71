"""How a disturbance of the leader's speed goes through a chain, all laws side by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, StrMethodFormatter

from pilotfish.formation.stability import Stability
from pilotfish.plots.laws import LawStyle, law_styles
from pilotfish.plots.style import LIGHT, Theme, style

_TICKS = (1.0, 2.0, 5.0)


def draw_string_stability(results: Sequence[Stability], title: str, theme: Theme = LIGHT) -> Figure:
    """Left: the greatest gain from one robot to the next, and from the leader to the last robot, over the frequency.
    Right: the greatest gain from the leader to the last robot of chains of 2 robots and more; how far each robot's
    distance is off after a step of the leader's speed. Results of one headway: a line is a law."""
    with style(theme):
        figure = Figure(figsize=(9.6, 7.2))
        (between, lengths), (through, step) = figure.subplots(2, 2)
        styles = law_styles([result.law for result in results], theme)
        for result in results:
            line = styles[result.law].line()
            between.plot(result.frequencies_hz, _greatest(result.gain), **line)
            through.plot(result.frequencies_hz, result.from_leader[:, -1], **line)
            robots = np.arange(2, 2 + result.gain.shape[1])
            lengths.plot(robots, result.peak_from_leader, **_dotted(styles[result.law]))
            step.plot(robots - 1, 1000.0 * result.step.peak_error_m, **_dotted(styles[result.law]))
        _finish_gain(between, "greatest gain,\nrobot to robot", theme)
        _finish_gain(through, "gain, leader to\nlast robot", theme)
        between.set_ylim(top=max(2.0, between.get_ylim()[1]))
        lengths.set_yscale("log")
        lengths.axhline(1.0, color=theme.guide, linewidth=0.8)
        lengths.set_xlabel("robots in the chain, with the leader [-]")
        lengths.set_ylabel("peak gain, leader\nto last robot [-]")
        step.set_xlabel("robot behind the leader [-]")
        step.set_ylabel("after a step: greatest\ndistance error [mm]")
        for axes in (lengths, step):
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        for axes in (between, lengths):
            axes.yaxis.set_major_locator(LogLocator(subs=_TICKS))
        for axes in (between, through, lengths):
            axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axes.yaxis.set_minor_formatter("")
        figure.align_ylabels()
        figure.suptitle(title, x=0.01, ha="left", fontsize=11, weight="bold")
        handles = [figure.axes[0].lines[k] for k in range(len(results))]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(results))
    return figure


def _greatest(gain: np.ndarray) -> np.ndarray:
    """(F,): of all robots; nan where no robot was measured."""
    known = np.where(np.isfinite(gain), gain, -np.inf).max(axis=1)
    return np.where(np.isfinite(known), known, np.nan)


def _dotted(own: LawStyle) -> dict[str, object]:
    return own.line(marker="o", markersize=3.5)


def _finish_gain(axes: Axes, label: str, theme: Theme) -> None:
    axes.axhline(1.0, color=theme.guide, linewidth=0.8)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=_TICKS))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter("")
    axes.set_xlabel("frequency of the leader's speed [Hz]")
    axes.set_ylabel(f"{label} [-]")
