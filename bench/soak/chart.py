"""What a soak found, as a picture: memory, descriptors and threads over robot time, recovery times by fault."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from census import HOUR_S, SETTLED_S
from fault_kinds import FAULTS
from goals import RECOVERY_S, recoveries
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from run import Soak

from pilotfish.plots.style import BLUE, ORANGE, SETPOINT, VERMILLION, save, style

_COLOURS = (BLUE, ORANGE)


def draw(soak: Soak, file: Path) -> Path:
    with style():
        figure = Figure(figsize=(13, 9))
        left, right = figure.subfigures(1, 2, width_ratios=(1.0, 1.1))
        memory, descriptors, threads = left.subplots(3, 1, sharex=True, height_ratios=(2, 1, 1))
        for (name, census), colour in zip(soak.census.items(), _COLOURS, strict=False):
            hours, minutes = np.array(census.at_s) / HOUR_S, census.minutes()
            settled = minutes.low_mb[np.searchsorted(minutes.at_s, SETTLED_S) if minutes.at_s[-1] >= SETTLED_S else 0]
            low, high, label = minutes.low_mb - settled, minutes.high_mb - settled, f"{name} ({settled:.0f} MB)"
            memory.fill_between(minutes.at_s / HOUR_S, low, high, color=colour, alpha=0.25, linewidth=0)
            memory.plot(minutes.at_s / HOUR_S, low, color=colour, label=label)
            descriptors.plot(hours, census.descriptors, color=colour, label=name)
            threads.plot(hours, census.threads, color=colour, label=name)
        memory.axvline(SETTLED_S / HOUR_S, color=SETPOINT, linewidth=0.8, linestyle=":")
        memory.axhline(1.0, color=VERMILLION, linewidth=1.0, linestyle="--", label="goal, from 10 min on")
        memory.set(title="Memory above that at 10 min (each minute's range)", ylabel="MB")
        descriptors.set(title="Open file descriptors", ylim=(0, None))
        threads.set(title="Threads", ylim=(0, None), xlabel="robot time [h]")
        for axes in (memory, descriptors, threads):
            axes.legend(loc="best")
        _draw_recoveries(soak, right.subplots())
        title = f"{soak.robot_s / HOUR_S:.2f} h of robot time at {soak.rate_hz:g} Hz, {len(soak.played)} faults"
        figure.suptitle(title, fontweight="bold")
        return save(figure, file)


def _draw_recoveries(soak: Soak, axes: Axes) -> None:
    """A histogram a fault: in each row, every recovery time with the share of the faults that took as long."""
    found = recoveries(soak)
    kinds = [kind for kind in FAULTS if kind in found][::-1]
    for row, kind in enumerate(kinds):
        times_s = np.array(found[kind])
        edges = np.arange(-0.5, times_s.max() * soak.rate_hz + 1.5) / soak.rate_hz
        counts, _ = np.histogram(times_s, edges)
        middles, shown = (edges[1:] + edges[:-1]) / 2, counts > 0
        areas = 8 + 200 * counts[shown] / counts.sum()
        axes.scatter(middles[shown], np.full(len(areas), row), s=areas, color=BLUE, alpha=0.6, linewidths=0)
        words = f"{len(times_s)}x, at most {times_s.max():.2f} s"
        axes.annotate(words, (1.02, row), xycoords=("axes fraction", "data"), va="center", fontsize=8)
    axes.axvline(RECOVERY_S, color=VERMILLION, linewidth=1.0, linestyle="--")
    axes.set_yticks(range(len(kinds)), [FAULTS[kind].words for kind in kinds])
    axes.set(title="Recovery: first good picture to tracking (area: share)", xlabel="robot time [s]")
    axes.set_xlim(-0.03, None)
