"""``pilotfish top`` in a terminal that is too narrow for all columns."""

from __future__ import annotations

from on_screen import on_screen, until
from robot_messages import base, command, observation, status
from test_top import Speaker, cell, detail, until_robots

from pilotfish.harness.ports import private_lcm_url
from pilotfish.top.app import TopApp


def test_what_a_narrow_terminal_does_not_show_is_said_below_of_the_selected_robot():
    """80 columns end before the rate of the pictures; 400 have room for everything."""
    told, url = {}, private_lcm_url()
    for width in (80, 400):
        app = TopApp(url)

        async def look(pilot, app=app, width=width):
            await until_robots(pilot, app, 1)
            await until(pilot, lambda: "driving" in cell(app, "robot1", "wheels"), "the wheels")
            await until(pilot, lambda: "tracking" in detail(app), "the status")
            app.show()
            told[width] = detail(app)

        messages = {"STATUS": status(), "COMMAND": command(), "OBSERVATION": observation(1.1), "BASE": base()}
        with Speaker(url, **{f"ROBOT1_{kind}": message for kind, message in messages.items()}):
            on_screen(app, look, size=(width, 24))
    assert "fps: 30.0" in told[80] and "wheels: driving" in told[80].splitlines()[1]
    assert "d [m]" not in told[80]  # it is in the table
    assert "fps:" not in told[400]
