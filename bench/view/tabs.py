"""How long the coordinator takes from a picture to its command, with and without pages that watch it."""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import lcm
import yaml

from bench.common.configuration import shipped_coordinator
from bench.common.processes import process
from pilotfish import data
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.pilotfish import command_t, status_t

PREVIEW_HZ = 10.0
SETTLE_S = 4.0  # the leader is found, and the pages are connected


def watch(host: str) -> None:
    """A page: takes what comes and acknowledges it, as the script in a browser does. Until killed."""
    from websockets.sync.client import connect

    with connect(f"ws://{host}/ws?robot=robot1", origin=f"http://{host}", max_size=None) as page:
        for message in page:
            page.send("state" if isinstance(message, str) else "picture")


@contextmanager
def _robot(folder: Path, url: str, seconds: float) -> Iterator[None]:
    """The real programs in real time: rendered pictures at 30 Hz, and a preview for people."""
    config = folder / "robot1.yaml"
    config.write_text(yaml.safe_dump(shipped_coordinator() | {"preview": {"rate_hz": PREVIEW_HZ}}))
    sim = [find_executable(SIM), "--scenario", data.path("scenarios/circle.yaml"), "--realtime", "--lcm-url", url]
    with (
        Child([find_executable(COORDINATOR), "--config", config, "--lcm-url", url], folder, "coordinator"),
        Child([*sim, "--duration-s", str(seconds + 60.0)], folder, "sim"),
    ):
        yield


def latencies_ms(tabs: int, seconds: float) -> list[float]:
    """Of every command that answered a picture in so many seconds [ms]: from the picture's arrival until it is sent."""
    url = private_lcm_url()
    bus, latencies, counted_from_s = lcm.LCM(url), [], [0.0]

    def take(_: str, message: bytes) -> None:
        status = status_t.decode(message)
        if status.status == command_t.STATUS_TRACKING and time.monotonic() >= counted_from_s[0]:
            latencies.append(1e3 * status.latency_s)

    bus.subscribe("ROBOT1_STATUS", take)
    view = [sys.executable, "-m", "pilotfish", "view", "robot1", "--lcm-url", url, "--port", "0"]
    with tempfile.TemporaryDirectory() as name, ExitStack() as running:
        folder = Path(name)
        running.enter_context(_robot(folder, url, seconds))
        server = running.enter_context(Child([*view, "--config", data.path("config/line.yaml")], folder, "view"))
        server.wait_until(lambda: "Ctrl-C" in server.stdout(), 20.0, "being ready")
        for _ in range(tabs):
            running.enter_context(process(watch, urlsplit(server.stdout().split()[0]).netloc))
        counted_from_s[0] = time.monotonic() + SETTLE_S
        while time.monotonic() < counted_from_s[0] + seconds:
            bus.handle_timeout(100)
    return latencies
