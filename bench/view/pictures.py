"""The pictures of the page in docs/images: a robot that follows on the circle, and the same robot stopped.

Takes: 1 minute. It waits for the robot, so a slow computer makes no other pictures, but for the rates on them.
PYTHONPATH=. python bench/view/pictures.py --out docs/images
"""

from __future__ import annotations

import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import typer
from measure import CHROMIUM

from pilotfish import data
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.harness.ports import private_lcm_url

FOLLOWS_S = 30.0  # the last minute's curves and the path are half full
REDRAWN_S = 2.0  # what is drawn on canvases takes the new colours with the next messages
DESKTOP, PHONE = {"width": 1400, "height": 1000}, {"width": 390, "height": 844}


def main(out: Annotated[Path, typer.Option(help="Folder for view-*.png.")] = Path("out")) -> None:
    """Takes view-desktop.png, view-desktop-dark.png, view-phone.png (dark) and view-phone-light.png."""
    from playwright.sync_api import sync_playwright

    out.mkdir(parents=True, exist_ok=True)
    url, config = private_lcm_url(), data.path("config/circle.yaml")
    with tempfile.TemporaryDirectory() as temporary, ExitStack() as stack:

        def start(name: str, *words: object) -> Child:
            return stack.enter_context(Child([*map(str, words), "--lcm-url", url], Path(temporary), name))

        coordinator = start("coordinator", find_executable(COORDINATOR), "--config", config)
        coordinator.wait_until(lambda: " ready: " in coordinator.stdout() + coordinator.stderr(), 20.0, "being ready")
        view = start("view", sys.executable, "-m", "pilotfish", "view", "robot1", "--config", config, "--port", "0")
        view.wait_until(lambda: "Ctrl-C" in view.stdout(), 20.0, "being ready")
        browser = stack.enter_context(sync_playwright()).chromium.launch(
            executable_path=str(CHROMIUM), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport=DESKTOP, color_scheme="light")  # one: each takes time from the robot
        page.goto(view.stdout().split()[0])
        scenario = data.path("scenarios/circle.yaml")  # it must not end before the last picture is taken
        start("sim", find_executable(SIM), "--scenario", scenario, "--realtime", "--duration-s", 4 * FOLLOWS_S)
        page.wait_for_selector('body[data-live="live"]')
        time.sleep(FOLLOWS_S)
        for name, scheme in (("view-desktop", "light"), ("view-desktop-dark", "dark")):
            page.emulate_media(color_scheme=scheme)
            time.sleep(REDRAWN_S)
            page.wait_for_function("() => document.body.innerText.includes('Following the leader')")
            page.screenshot(path=out / f"{name}.png", full_page=True)
        page.set_viewport_size(PHONE)
        for name, scheme in (("view-phone", "dark"), ("view-phone-light", "light")):
            page.emulate_media(color_scheme=scheme)
            page.wait_for_function("() => document.body.innerText.includes('Following the leader')")
            time.sleep(REDRAWN_S)
            page.keyboard.press("Escape")
            page.wait_for_function(
                "() => ['confirmed', 'Stopped'].every((word) => document.body.innerText.includes(word))"
            )
            page.screenshot(path=out / f"{name}.png")
            page.get_by_role("button", name="Resume").click()  # at once: the leader drives on
            page.evaluate("() => scrollTo(0, 0)")
        browser.close()


if __name__ == "__main__":
    typer.run(main)
