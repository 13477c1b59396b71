"""Every figure that pilotfish draws, of runs written down by formula."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from synthetic_run import exponential_run

from pilotfish import data, fuzzy
from pilotfish.camera_view import CameraView
from pilotfish.formation import formations, load_formation
from pilotfish.formation.response import StepResponse
from pilotfish.formation.stability import Stability
from pilotfish.fuzzy_report import analyse
from pilotfish.plots.comparison import draw_comparison
from pilotfish.plots.distance_error import draw_distance_error
from pilotfish.plots.formation_picture import draw_formation
from pilotfish.plots.fuzzy_curve import draw_curve
from pilotfish.plots.fuzzy_explanation import draw_explanation
from pilotfish.plots.fuzzy_sets import draw_fuzzy_sets
from pilotfish.plots.overview import Summary, draw_overview
from pilotfish.plots.paths import draw_paths
from pilotfish.plots.string_stability import draw_string_stability
from pilotfish.plots.style import LIGHT, Theme
from pilotfish.plots.surface import draw_surface
from pilotfish.plots.sweep import draw_sensitivity, draw_sweep
from pilotfish.recording import Recording
from pilotfish.sweep.intervals import Curve, Interval
from pilotfish.sweep.sensitivity import Index, Sensitivity

LAWS = ("paper", "pbvs", "pid", "anticipate")


def view(time_s: float, **changes) -> CameraView:
    """A picture of noise with one tag in it."""
    corners = np.array([[100.0, 200.0], [200.0, 200.0], [200.0, 100.0], [100.0, 100.0]])
    image = np.random.default_rng(round(10 * time_s)).integers(0, 256, (480, 640), dtype=np.uint8)
    values = {"status": "tracking", "tags": ((7, corners),), "distance_m": 1.1, "bearing_rad": -0.1745}
    return CameraView(time_s=time_s, image=image, **(values | changes))


def runs(*laws: str) -> dict[str, Recording]:
    return {law: exponential_run(profile=law) for law in laws}


def chain() -> list[Recording]:
    """Three robots, each behind the one before, and no word about their law."""
    pairs = (("robot1", "leader"), ("robot2", "robot1"), ("robot3", "robot2"))
    return [exponential_run(robot=robot, leader=leader, profile="") for robot, leader in pairs]


def _law() -> fuzzy.Controller:
    return fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))


def _campaign(theme: Theme, x: np.ndarray) -> Figure:
    means = {law: 10.0 * (k + 1) * np.arange(1.0, 4.0) for k, law in enumerate(LAWS)}
    drawn = [Curve(law, x, [Interval(y, 0.8 * y, 1.2 * y, 5) for y in means[law]]) for law in LAWS]
    return draw_sweep(drawn, "leader speed [m/s]", "RMS distance error [mm]", "A campaign", theme=theme)


def _sensitivities(theme: Theme) -> Figure:
    total = {name: Index(0.2 * k, 0.05) for k, name in enumerate(("lag", "slip", "latency"), 1)}
    both = [Sensitivity(law, "sobol", {name: Index(0.1, 0.02) for name in total}, total, 640, 0) for law in LAWS[:2]]
    return draw_sensitivity(both, {name: f"{name} [s]" for name in total}, "What the error depends on", theme)


def _explanation(theme: Theme) -> Figure:
    return draw_explanation(_law(), -0.2, 0.1, fuzzy.InputWidths(error=0.1), theme)


def _stability(law: str) -> Stability:
    """Of a chain of four whose robots are first-order lags, or amplify."""
    frequencies_hz, robots = np.array([0.02, 0.1, 0.5, 1.0]), np.arange(1, 4)
    lag_s = 0.1 * (1 + LAWS.index(law))
    through = (1.0 + (2 * np.pi * frequencies_hz * lag_s)[:, None] ** 2) ** (-0.5 * robots)
    step = StepResponse(0.1 * robots, 0.01 * lag_s * robots, np.ones(2), np.ones(2))
    lost = np.zeros((4, 3), dtype=bool)
    gain = np.tile(through[:, :1], 3)
    return Stability(law, 0.0, frequencies_hz, gain, through, gain[:, 1:], np.zeros((4, 4)), lost, step, np.ones(3))


DRAW = {
    "one run": lambda theme: draw_distance_error(exponential_run(), "A run", theme),
    "paths": lambda theme: draw_paths([exponential_run()], "From above", theme),
    "paths of a chain": lambda theme: draw_paths(chain(), "A chain", theme),
    "comparison": lambda theme: draw_comparison({"A line": runs(*LAWS), "A circle": runs(*LAWS)}, theme),
    "comparison of unknown laws": lambda theme: draw_comparison({"A line": runs("mine", "yours", "paper")}, theme),
    "overview": lambda theme: draw_overview([Summary(name, runs(*LAWS), view(3.0)) for name in ("a", "b")], theme),
    "fuzzy sets": lambda theme: draw_fuzzy_sets(_law(), theme=theme),
    "surface": lambda theme: draw_surface(_law(), theme=theme),
    "curve": lambda theme: draw_curve(_law(), analyse(_law()), theme=theme),
    "explanation": _explanation,
    "campaign over a factor": lambda theme: _campaign(theme, np.array([0.1, 0.2, 0.3])),
    "campaign over names": lambda theme: _campaign(theme, np.array(["ideal", "late", "nonideal"])),
    "sensitivities": lambda theme: _sensitivities(theme),
    "formation": lambda theme: draw_formation(load_formation(formations()["column"]), theme),
    "string stability": lambda theme: draw_string_stability([_stability(law) for law in LAWS], "A chain", theme),
}


def drawn(which: str, theme: Theme = LIGHT) -> Figure:
    return DRAW[which](theme)
