"""Formations written down in a test."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pilotfish.formation import Formation
from pilotfish.formation.file import read_formation

HERE = Path("my_formation.yaml")


def formation(shape: str, **content: Any) -> Formation:
    """Of that shape; three robots, 1 m apart, unless said otherwise."""
    usual = {} if shape == "tree" else {"robots": 3, "spacing_m": 1.0}
    return read_formation({"name": "mine", "shape": shape, **usual, **content}, HERE)


def tree(*branches: tuple[str, float, float]) -> list[dict[str, Any]]:
    """``tree:`` of (leader, distance_m, bearing_deg)."""
    return [{"leader": leader, "distance_m": d, "bearing_deg": b} for leader, d, b in branches]
