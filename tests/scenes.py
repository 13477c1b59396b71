"""Pictures that several modules' tests need."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from pilotfish import core, sim
from pilotfish import data as shipped

PERIOD_US = 33_333


def scenario_with(name: str, part: str, **changes: float) -> sim.Scenario:
    """A shipped scenario whose robot has another ``camera`` or ``drive`` (``part``) than its coordinator is told."""
    scenario = sim.load_scenario(shipped.path(f"scenarios/{name}.yaml"))
    robots = scenario.robots
    changed = getattr(robots[1], part)
    for key, value in changes.items():
        setattr(changed, key, value)
    setattr(robots[1], part, changed)
    scenario.robots = robots
    return scenario


def leader_pictures(count: int, *, hidden_from: int | None = None, start_utime: int = 1_000_000) -> list[core.Frame]:
    """What the line scenario's coordinator sees if it stands still: the leader drives ahead. From frame
    ``hidden_from`` on the pictures are gray, with a sensor's noise."""
    scenario = sim.load_scenario(str(shipped.path("scenarios/line.yaml")))
    world = sim.World(scenario)
    robot = next(r.name for r in scenario.robots if r.follows)
    frames = []
    for k in range(count):
        world.advance_to(k / 30)
        image = world.capture(robot).image
        if hidden_from is not None and k >= hidden_from:
            noise = np.random.default_rng(k).integers(-2, 3, image.shape)  # the same picture twice is a frozen camera
            image = (128 + noise).astype(np.uint8)
        frames.append(core.Frame(image, utime=start_utime + k * PERIOD_US))
    return frames


def save_pictures(frames: list[core.Frame], folder: Path) -> None:
    """As PNG, with the times in frames.csv, as ``--source images:`` reads them."""
    folder.mkdir(exist_ok=True)
    for k, frame in enumerate(frames):
        Image.fromarray(frame.image).save(folder / f"{k}.png")
    lines = ["file,utime_us", *(f"{k}.png,{frame.utime}" for k, frame in enumerate(frames))]
    (folder / "frames.csv").write_text("\n".join(lines) + "\n")
