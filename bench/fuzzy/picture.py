"""The picture of the benchmark: ratios to the baselines, and the command variation with non-singleton inputs."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure
from measure import Row, Width

from pilotfish.plots.style import BLUE, GREEN, ORANGE, SKY, VERMILLION, save, style


def draw(rows: list[Row], curve: list[Width], file: Path) -> Path:
    """Left the ratios with their goals, right the RMS change of the law's speed output over k."""
    with style():
        figure = Figure(figsize=(12.0, 4.6))
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1.0))
        places = range(len(rows))
        left.barh(places, [r.ratio for r in rows], color=[BLUE if r.met else VERMILLION for r in rows], height=0.6)
        left.scatter([r.goal for r in rows], places, marker="|", s=300, color=ORANGE, label="goal", zorder=3)
        left.set_yticks(places, [f"{r.what}\nagainst {r.baseline}" for r in rows], fontsize=8)
        left.invert_yaxis()
        left.set_xscale("log")
        left.set_xlabel("times faster than the baseline")
        left.set_title("Speed")
        left.legend(loc="upper right")
        left.set_axisbelow(True)
        left.set_xlim(10.0, 4.0 * max(r.ratio for r in rows))

        sigmas = sorted({w.sigma_m for w in curve})
        for sigma_m, colour in zip(sigmas, (SKY, GREEN, BLUE, VERMILLION), strict=False):
            points = [w for w in curve if w.sigma_m == sigma_m and w.wanted_change_ratio is not None]
            k, ratios = [w.input_sigmas for w in points], [w.wanted_change_ratio for w in points]
            right.plot([0.0, *k], [1.0, *ratios], "o-", color=colour, label=f"sigma {sigma_m * 1e3:.0f} mm")
        right.set_ylim(0.0, 1.1)
        right.set_xlabel("width of the inputs, k sigma")
        right.set_ylabel("RMS change of the speed output,\nagainst singletons at the same steady-state error")
        right.set_title("Command variation")
        right.legend()
    return save(figure, file)
