"""What `pilotfish view` costs without a page and with one, and how old a picture is when the page draws it."""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sender import send

from bench.common.processes import process
from pilotfish import data
from pilotfish.harness.child import Child
from pilotfish.harness.ports import private_lcm_url

CHROMIUM = "/usr/bin/chromium"
ARGUMENTS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
)
WARM_UP_S = 3.0
_TICKS_PER_S = os.sysconf("SC_CLK_TCK")

# Exposure to the event that the page sends when it has drawn a picture, and to the next frame of the browser, in which
# the drawing is composed. All clocks are this host's wall clock.
_LISTEN = """() => {
  window.drawn_ms = []; window.composed_ms = [];
  document.getElementById("picture").addEventListener("picturedrawn", (event) => {
    const age = () => performance.timeOrigin + performance.now() - event.detail.utime_us / 1e3;
    window.drawn_ms.push(age());
    requestAnimationFrame(() => window.composed_ms.push(age()));
  });
}"""


@contextmanager
def viewing(rate_hz: float, picture_kind: str, picture_hz: float) -> Iterator[Child]:
    """A running `pilotfish view`, and a robot that sends."""
    url = private_lcm_url()
    command = [sys.executable, "-m", "pilotfish", "view", "robot1", "--lcm-url", url, "--port", "0"]
    command += ["--config", data.path("config/line.yaml")]
    with (
        tempfile.TemporaryDirectory() as folder,
        process(send, url, rate_hz, picture_kind, picture_hz),
        Child(command, Path(folder), "view") as child,
    ):
        child.wait_until(lambda: "Ctrl-C" in child.stdout(), 20.0, "being ready")
        yield child


def load(child: Child, seconds: float) -> float:
    """Share of one core that a process takes, in so many seconds."""
    time.sleep(WARM_UP_S)
    before, start_s = _cpu_s(child.process.pid), time.monotonic()
    time.sleep(seconds)
    return (_cpu_s(child.process.pid) - before) / (time.monotonic() - start_s)


def _cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_PER_S


@contextmanager
def page_of(child: Child) -> Iterator[Any]:
    """A page in Chromium that watches."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS.split())
        page = browser.new_page(viewport={"width": 1400, "height": 1000})
        page.goto(child.stdout().split()[0])
        page.wait_for_selector('body[data-live="live"]')
        yield page
        browser.close()


def ages(page: Any, pictures: int) -> tuple[list[float], list[float]]:
    """Ages [ms] of so many pictures when they were drawn, and when they were composed."""
    page.wait_for_timeout(WARM_UP_S * 1e3)
    page.evaluate(_LISTEN)
    page.wait_for_function("n => window.composed_ms.length >= n", arg=pictures, timeout=pictures * 1e3 + 30e3)
    return page.evaluate("window.drawn_ms"), page.evaluate("window.composed_ms")
