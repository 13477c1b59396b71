"""The pictures of docs/obstacles.md: a wedge among obstacles from above, and through the camera of one of its robots.

python bench/obstacles/picture.py docs/images
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image

from pilotfish import data, sim
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.in_process import FrameEvent, run_in_process
from pilotfish.harness.scenario import Scenario
from pilotfish.plots.obstacles import draw_among_obstacles

CAMERA, CAMERA_AT_S = "robot1", 9.0


def main(folder: Path) -> None:
    scenario = Scenario.load(data.path("scenarios/wedge_obstacles.yaml"))
    spec = sim.load_scenario(scenario.file)
    pictures: list[Image.Image] = []

    def look(event: FrameEvent) -> None:
        if event.robot == CAMERA and not pictures and event.time_s >= CAMERA_AT_S:
            pictures.append(Image.fromarray(event.world.capture(CAMERA).image))

    drawn = DrawnObservations(spec.seed, occlusion=True)
    run = run_in_process(scenario, profile="anticipate", drawn=drawn, on_frame=look)
    figure = draw_among_obstacles(list(run.recordings.values()), spec.all_obstacles(), "A wedge among obstacles")
    figure.savefig(folder / "obstacles.png", dpi=150)
    pictures[0].save(folder / "obstacles_camera.png")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
