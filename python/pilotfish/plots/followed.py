"""Who a robot followed, and at which distance, where it may follow more than one."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from pilotfish.formation.run import FormationRun
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.recording import FloatArray

_WIDTH_IN, _HEIGHT_IN = 7.2, 4.6


def draw_followed(run: FormationRun, robot: str, theme: Theme = LIGHT) -> Figure:
    """Distances from ``robot`` to each robot that it may follow, thick while it follows that one, and its speed.
    KeyError if the robot follows nobody."""
    recording = run.recordings[robot]
    time_s, since = recording.time_s, run.followed[robot]
    names = list(dict.fromkeys([since[0][1], *(watch.leader for watch in run.formation.otherwise.watches[robot])]))
    begins_s = np.array([at_s for at_s, _ in since])
    now = np.searchsorted(begins_s, time_s + 1e-9, side="right") - 1
    with style(theme):
        figure = Figure(figsize=(_WIDTH_IN, _HEIGHT_IN))
        distances, speeds = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        for k, name in enumerate(names):
            x_m, y_m = _place(run, name)
            distance_m = np.hypot(x_m - recording.x_m, y_m - recording.y_m)
            followed = np.array([since[which][1] == name for which in now])
            (line,) = distances.plot(time_s, distance_m, linewidth=0.8, linestyle=":", color=f"C{k}")
            own = np.where(followed, distance_m, np.nan)
            distances.plot(time_s, own, linewidth=2.4, color=line.get_color(), label=name)
        for dropout in run.formation.dropouts:
            for axes in (distances, speeds):
                axes.axvspan(dropout.at_s, min(dropout.until_s, time_s[-1]), color=theme.guide, alpha=0.15, linewidth=0)
            distances.text(
                dropout.at_s,
                0.6,
                f" {dropout.robot} not to be seen",
                va="top",
                transform=distances.get_xaxis_transform(),
            )
        speeds.plot(time_s, recording.linear_mps, color=theme.guide)
        distances.set_ylabel("distance [m]")
        speeds.set_ylabel("speed [m/s]")
        speeds.set_xlabel("time [s]")
        distances.set_title(f"{run.formation.name}: whom {robot} follows (thick), and how far it is")
        figure.legend(loc="outside lower center", ncols=len(names), fontsize=9)
    return figure


def _place(run: FormationRun, name: str) -> tuple[FloatArray, FloatArray]:
    """(N,) x and y [m] of a robot, or of the leader in front as seen from whoever follows it."""
    if name in run.recordings:
        return run.recordings[name].x_m, run.recordings[name].y_m
    of = next(r for r in run.recordings.values() if r.meta.leader == name)
    return of.leader_x_m, of.leader_y_m
