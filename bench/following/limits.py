"""Why a row is not met: the same run with one imperfection after the other taken away."""

from __future__ import annotations

from figures import LAG_S, LATENCY_S, figures_of
from play import play

from pilotfish import sim


def _more_acceleration(robot: sim.RobotSpec) -> None:
    drive = robot.drive
    drive.max_linear_acceleration_mps2 = 10.0
    robot.drive = drive


WITHOUT = {
    "drawn measurements": {"noise": 1.0},
    "without noise": {"noise": 0.0},
    "without latency": {"noise": 1.0, "delays": (0.001, LAG_S)},
    "without lag": {"noise": 1.0, "delays": (LATENCY_S, 0.0)},
    "with 10 m/s2": {"noise": 1.0, "change": _more_acceleration},
    "without any of them": {"noise": 0.0, "delays": (0.001, 0.0), "change": _more_acceleration},
}


def limit_curve(scenario: str, figure: str, seed: int = 1) -> dict[str, float]:
    """The figure of profile `anticipate`, by what was taken away."""
    return {
        words: figures_of(scenario, play(scenario, "anticipate", seed, **changes))[figure]
        for words, changes in WITHOUT.items()
    }
