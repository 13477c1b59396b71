"""Campaigns that tests write: short runs, few of them."""

from __future__ import annotations

from pathlib import Path

import yaml

from pilotfish.sweep.campaign import Campaign, load_campaign
from pilotfish.sweep.results import Results
from pilotfish.sweep.store import read_rows

SPEED = "robots.leader.trajectory.speed_mps"
SHORT_S = 1.0


def written(folder: Path, name: str = "campaign.yaml", **changes: object) -> Path:
    """A campaign's file; None takes a key away."""
    said = {
        "scenario": "line",
        "duration_s": SHORT_S,
        "runs": 2,
        "factors": {"law": ["paper", "pid"], SPEED: [0.1, 0.2]},
        "metrics": ["rms_distance_mm", "settling_s", "min_distance_m"],
    } | changes
    file = folder / name
    file.write_text(yaml.safe_dump({key: value for key, value in said.items() if value is not None}, sort_keys=False))
    return file


def loaded(folder: Path, **changes: object) -> Campaign:
    """The same, read."""
    return load_campaign(written(folder, **changes))


def rows(out: Path) -> list[dict]:
    """All rows, in the order of the runs."""
    return read_rows(out).to_pylist()


def made_up(factors: dict[str, dict], columns: dict, sampling: dict, metric: str = "rms_distance_mm") -> Results:
    """Results of a campaign that nobody ran."""
    identity = {"factors": factors, "metrics": [metric], "runs": 1, "scenario": "line", "sampling": sampling}
    return Results(identity, columns)
