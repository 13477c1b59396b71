"""The buttons of the page move, and stop, a real coordinator with a simulator in real time."""

from __future__ import annotations

from contextlib import ExitStack

import lcm
import pytest
from test_view_page import text, wait_for_text
from view_server import serving

from pilotfish import data
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.lcmtypes.pilotfish.command_t import command_t


@pytest.fixture
def robot(tmp_path, url):
    """A coordinator that drives behind a simulated leader, and a server beside it: (coordinator, address)."""
    with ExitStack() as stack:
        command = [find_executable(COORDINATOR), "--config", data.path("config/line.yaml"), "--lcm-url", url]
        coordinator = stack.enter_context(Child(command, tmp_path, "coordinator"))
        coordinator.wait_until(lambda: " ready: " in coordinator.stdout() + coordinator.stderr(), 20.0, "being ready")
        scenario = ["--scenario", data.path("scenarios/line.yaml"), "--realtime", "--duration-s", "60"]
        stack.enter_context(Child([find_executable(SIM), *scenario, "--lcm-url", url], tmp_path, "sim"))
        options = ["robot1", "--lcm-url", url, "--config", data.path("config/line.yaml")]
        yield coordinator, stack.enter_context(serving(tmp_path, *options)).address


class Wheels:
    """The commands as the wheels receive them."""

    def __init__(self, url):
        self.bus = lcm.LCM(url)
        self.newest = None
        self.bus.subscribe("ROBOT1_COMMAND", lambda _, data: setattr(self, "newest", command_t.decode(data)))

    def wait_until(self, condition, what):
        for _ in range(400):
            self.bus.handle_timeout(50)
            if self.newest is not None and condition(self.newest):
                return
        raise AssertionError(what)


def test_stop_resume_and_setpoint_do_what_they_say_and_a_killed_coordinator_is_named(robot, url, browser):
    coordinator, address = robot
    page, phone = browser.open(address), browser.open(address, width=390)
    wheels = Wheels(url)
    wheels.wait_until(lambda c: c.linear_mps > 0.05, "it never drove")
    page.wait_for_selector("#picture[data-tags*='0']")

    page.click("#stop")
    wheels.wait_until(lambda c: c.status == command_t.STATUS_STOPPED, "STOP did not stop it")
    assert (wheels.newest.linear_mps, wheels.newest.angular_radps) == (0.0, 0.0)
    page.wait_for_selector("#outcome[data-state=confirmed]")
    for each in (page, phone):
        wait_for_text(each, "#headline", "Stopped")

    phone.fill("#distance", "1.25")
    phone.fill("#bearing", "-5")
    phone.locator("#set").evaluate("button => button.scrollIntoView({block: 'center'})")  # clear of the bar on top
    phone.click("#set")
    phone.wait_for_selector("#outcome[data-state=confirmed]")
    assert "would keep 1.25 m at -5.0 deg" in text(phone, "#outcome")
    assert wheels.newest.status == command_t.STATUS_STOPPED  # a setpoint ends no stop
    page.wait_for_function("() => document.getElementById('distance').value === '1.25'")

    page.click("#resume")
    wheels.wait_until(lambda c: c.status == command_t.STATUS_TRACKING, "it was not resumed")
    page.wait_for_selector("#outcome[data-state=confirmed]")

    for key, focus in (("Escape", "#distance"), ("Space", "#resume")):
        page.focus(focus)
        page.keyboard.press(key)
        wheels.wait_until(lambda c: c.status == command_t.STATUS_STOPPED, f"{key} did not stop it")
        wait_for_text(page, "#stop-note", "confirmed")
        page.click("#resume")
        wheels.wait_until(lambda c: c.status == command_t.STATUS_TRACKING, f"not resumed after {key}")
        page.wait_for_selector("#resume:not(:disabled)")

    coordinator.process.kill()
    for each in (page, phone):
        each.wait_for_selector('body[data-live="silent"]')
    page.click("#stop")
    page.wait_for_selector("#outcome[data-state=refused]")
    assert "stops were sent, and none was confirmed" in text(page, "#outcome")
    complaints = [said for said in browser.complaints if "409" not in said]  # Chromium logs what is not confirmed
    assert complaints == []
