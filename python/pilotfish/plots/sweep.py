"""What came of a campaign: a figure over a factor with intervals, and what the figure depends on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pilotfish.harness.driving import BASELINES, PROFILES
from pilotfish.plots.laws import LawStyle, law_colour, law_styles
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.sweep.intervals import Curve
from pilotfish.sweep.sensitivity import Sensitivity

_DASHES: tuple[Any, ...] = ("-", (0.0, (7.0, 2.0)), (0.0, (6.0, 1.5, 1.5, 1.5)), (0.0, (1.5, 1.5)))
_MARKERS = "osD^v<>"
INTERVAL_NAMES = {"t": "95 % t intervals", "bootstrap": "95 % bootstrap intervals"}
_METHOD_NAMES = {"sobol": ("first-order index", "total index"), "pawn": ("", "PAWN index")}


def draw_sweep(
    curves: Sequence[Curve],
    x_label: str,
    y_label: str,
    title: str,
    interval: str = "t",
    logarithmic: bool = False,
    theme: Theme = LIGHT,
) -> Figure:
    """Means as points and lines, intervals as bars. The labels have units; texts on the x axis stand side by side."""
    with style(theme):
        figure = Figure(figsize=(7.2, 4.8))
        axes = figure.subplots()
        axes.set_title(title)
        texts = _texts(curves)
        lines = _lines([curve.name for curve in curves], theme)
        for k, curve in enumerate(curves):
            shift = 0.12 * (k - (len(curves) - 1) / 2.0)
            x = np.array([texts.index(text) + shift for text in curve.x.tolist()]) if texts else curve.x
            _draw_curve(axes, x, curve, lines[curve.name], _MARKERS[k % len(_MARKERS)], bool(texts))
        if texts:
            axes.set_xticks(range(len(texts)), texts)
        if logarithmic:
            axes.set_yscale("log")
        elif all(each.mean >= 0.0 for curve in curves for each in curve.intervals):
            axes.set_ylim(bottom=-0.02 * axes.get_ylim()[1])
        axes.set_xlabel(x_label)
        counts = [each.count for curve in curves for each in curve.intervals]
        runs = f"{min(counts)}" if min(counts) == max(counts) else f"{min(counts)} to {max(counts)}"
        axes.set_ylabel(f"{y_label}\nmean of {runs} runs, {INTERVAL_NAMES[interval]}")
        if len(curves) > 1:
            figure.legend(loc="outside lower center", ncols=min(4, len(curves)), handlelength=3.5)
    return figure


def _texts(curves: Sequence[Curve]) -> list[str]:
    if all(curve.x.dtype.kind in "fi" for curve in curves):
        return []
    return list(dict.fromkeys(str(text) for curve in curves for text in curve.x.tolist()))


def _lines(names: Sequence[str], theme: Theme) -> dict[str, LawStyle]:
    """Laws as everywhere; whatever else is compared, by colour and dashes in turn."""
    if set(names) <= {*PROFILES, *BASELINES}:
        return law_styles(names, theme)
    colours = theme.lines
    return {
        name: LawStyle(name, colours[k % len(colours)], _DASHES[k % len(_DASHES)], 1.8, 2.0 + 0.1 * k)
        for k, name in enumerate(names)
    }


def _draw_curve(axes: Axes, x: np.ndarray, curve: Curve, line: LawStyle, marker: str, apart: bool) -> None:
    means = np.array([each.mean for each in curve.intervals])
    below = np.array([each.mean - each.low for each in curve.intervals])
    above = np.array([each.high - each.mean for each in curve.intervals])
    arguments = line.line(linestyle="none") if apart else line.line()
    if not curve.name:
        arguments["label"] = None
    axes.errorbar(
        x,
        means,
        yerr=np.nan_to_num([below, above]),
        marker=marker,
        markersize=4.5,
        capsize=3.0,
        elinewidth=1.2,
        **arguments,
    )


def draw_sensitivity(found: Sequence[Sensitivity], labels: dict[str, str], title: str, theme: Theme = LIGHT) -> Figure:
    """Two bars with intervals for each factor, the most influential on top; a column for each group."""
    names = sorted(found[0].total, key=lambda name: max(each.total[name].value for each in found))
    first, total = _METHOD_NAMES[found[0].method]
    with style(theme):
        figure = Figure(figsize=(3.2 + 3.6 * len(found), 1.7 + 0.55 * len(names)))
        row = figure.subplots(1, len(found), squeeze=False, sharey=True, sharex=True)[0]
        for axes, each in zip(row, found, strict=True):
            colour = law_colour(each.group, theme) if each.group in (*PROFILES, *BASELINES) else theme.other_law
            for offset, indices, filled, label in ((0.2, each.total, False, total), (-0.2, each.first, True, first)):
                if not indices:
                    continue
                axes.barh(
                    np.arange(len(names)) + offset,
                    [indices[name].value for name in names],
                    0.36,
                    xerr=[indices[name].half_width for name in names],
                    color=colour if filled else "none",
                    edgecolor=colour,
                    ecolor=theme.ink,
                    capsize=2.5,
                    error_kw={"elinewidth": 1.0},
                    label=label,
                )
            if each.group:
                axes.set_title(each.group)
            axes.axvline(0.0, color=theme.guide, linewidth=0.8)
            axes.set_ylabel("factor [-]")
            axes.set_xlabel("share [-]" if each.method == "sobol" else "index [-]")
            axes.grid(False, axis="y")
        row[0].set_yticks(range(len(names)), [labels[name] for name in names])
        figure.suptitle(title, x=0.01, ha="left", fontweight="bold", fontsize=11)
        handles, texts = row[0].get_legend_handles_labels()
        figure.legend(handles, texts, loc="outside lower right", ncols=2, title="95 % bootstrap intervals")
    return figure
