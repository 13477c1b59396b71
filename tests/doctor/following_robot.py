"""A robot made of the real programs on a bus of its own, to be watched."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import yaml

from pilotfish import data
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, COORDINATOR, SIM, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.watching import Feed

LINE_CONFIG = data.path("config/line.yaml")
LINE_SCENARIO = data.path("scenarios/line.yaml")
READY_S = 20.0


class WatchedRobot:
    """Starts programs one by one; all of them end with the context."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.url = folder, private_lcm_url()
        self._children = ExitStack()

    def __enter__(self) -> WatchedRobot:
        return self

    def __exit__(self, *_: object) -> None:
        self._children.close()

    def start(self, name: str, program: str, *options: object, ready: str = "") -> Child:
        """Waits until it has said ``ready`` on one of its streams."""
        words = [find_executable(program), *map(str, options), "--lcm-url", self.url]
        child = self._children.enter_context(Child(words, self.folder, name))
        if ready:
            child.wait_until(lambda: ready in child.stderr() + child.stdout(), READY_S, f"saying '{ready}'")
        return child

    def coordinator(self, config: Path = LINE_CONFIG, *options: object, name: str = "coordinator") -> Child:
        return self.start(name, COORDINATOR, "--config", config, *options, ready=" ready: ")

    def base(self, config: Path | None = None, *options: object) -> Child:
        return self.start("base", BASE, "--config", config or data.path("config/base.yaml"), *options, ready=" bus ")

    def sim(self, *options: object, images: bool = True) -> Child:
        """In real time, and sending pictures when this returns."""
        child = self.start("sim", SIM, "--scenario", LINE_SCENARIO, "--realtime", *options)
        if images:
            self.wait_for_messages(child, "ROBOT1_IMAGE", 5)
        return child

    def wait_for_messages(self, child: Child, channel: str, count: int) -> None:
        received = []
        feed = Feed(self.url, received.append, channels=channel)

        def enough() -> bool:
            feed.handle(0.02)
            return len(received) >= count

        child.wait_until(enough, READY_S, f"sending {count} messages on {channel}")


def edited_config(folder: Path, change) -> Path:
    """data/config/line.yaml with something changed; the paths in it become absolute."""
    content = yaml.safe_load(LINE_CONFIG.read_text())
    for place, key in ((content["camera"], "calibration"), (content, "leader"), (content, "fuzzy")):
        place[key] = str((LINE_CONFIG.parent / place[key]).resolve())
    change(content)
    file = folder / "edited.yaml"
    file.write_text(yaml.safe_dump(content))
    return file


def with_other_ids(content) -> None:
    content["leader"] = str(data.path("leaders/three_faces_second.yaml"))


def half_size_calibration(folder: Path) -> Path:
    """The simulated camera's at 320x240: every length in pixels is halved."""
    text = data.path("calibrations/sim_640x480.yaml").read_text()
    halves = {"width: 640": "width: 320", "height: 480": "height: 240", "600.0": "300.0", "321.3": "160.4"}
    for whole, half in {**halves, "238.6": "119.05"}.items():
        assert whole in text
        text = text.replace(whole, half)
    file = folder / "half.yaml"
    file.write_text(text)
    return file
