"""What the page shows is what is on the bus, and it says so when nothing is any more."""

from __future__ import annotations

import math
import re
from urllib.parse import urlsplit

import pytest
from view_server import serving

from pilotfish.lcmtypes.pilotfish import command_t
from robot_on_bus import (
    RobotOnBus,
    base,
    command,
    gray_image,
    observation,
    picture,
    status,
    with_lists,
)

DASH = "\u2013"


def text(page, selector):
    return page.inner_text(selector).replace("\u2212", "-")


def wait_for_text(page, selector, wanted):
    page.wait_for_function(
        """([selector, wanted]) =>
          document.querySelector(selector)?.textContent.replaceAll("\\u2212", "-").includes(wanted)""",
        arg=[selector, wanted],
    )


def columns_of(page, selector, columns):
    """Of every element: what the JavaScript expressions in it, `e`, give."""
    return page.eval_on_selector_all(selector, f"all => all.map((e) => [{columns}])")


def test_the_values_on_the_page_are_those_of_the_messages(shared, browser):
    said = with_lists(
        status(),
        strengths={25: 0.75, 26: 0.25},  # row 3 (NZ), columns 4 and 5 (PS, PM): 3 * 7 + 4 and + 5
        counters={"tag_foreign_id": 12, "frames_stale": 3},
        stages=[("looked", [0, 0, 90, 9, 1, 0, 0, 0, 0, 0, 0], 3.4)],  # median below 1 ms, 99 % below 2 ms
    )
    messages = {"STATUS": said, "BASE": base(), "PREVIEW": picture(gray_image())}
    with RobotOnBus(shared.url, "values", **messages):
        page = browser.open(shared.of("values"))
        page.wait_for_selector("#picture[data-tags='0 1']")
        wait_for_text(page, "#value-distance", "1.350")
        shown = {name: text(page, f"#value-{name}") for name in ("distance", "bearing", "heading", "linear", "angular")}
        assert shown == {
            "distance": "1.350",
            "bearing": "-12.50",
            "heading": "+4.0",
            "linear": "+0.321",
            "angular": "-0.250",
        }
        assert (text(page, "#value-rate"), text(page, "#value-latency")) == ("29.7", "38.5")
        assert "measured +0.300" in text(page, "#tiles")
        assert text(page, "#headline") == "Following the leader"
        assert "1.35 m away, 12.5° to the right; to keep: 1.10 m, 10.0° to the right" in text(page, "#lines")
        assert "2 tags (ids 0, 1) of the body's 3 (ids 0 to 2)" in text(page, "#lines")
        assert "reprojection error 0.12 px, limit 3" in text(page, "#lines")
        assert (page.input_value("#distance"), page.input_value("#bearing")) == ("1.1", "-10")
        # errors: 1.10 - 1.35 = -0.25 m; -12.5 + 10 = -2.5 deg
        wait_for_text(page, ".now[data-column=distance_error_mm]", "-250 mm")
        wait_for_text(page, ".now[data-column=bearing_error_deg]", "-2.50 °")
        page.wait_for_selector("#rules td[data-rule='NZ PS'][data-strongest]")
        # In one look: on a busy computer the table goes dark for a moment between two messages.
        page.wait_for_function(
            "want => JSON.stringify([...document.querySelectorAll('#rules td[data-fires]')]"
            ".map(e => [e.dataset.rule, e.dataset.strength])) === want",
            arg='[["NZ PS","0.75"],["NZ PM","0.25"]]',
        )
        stage = text(page, "#stages tbody tr").split()
        assert stage == ["vision", "and", "law", "<", "1", "ms", "<", "2", "ms", "3.4", "ms"]
        refused = columns_of(page, "#refused tr", "e.dataset.counter, e.cells[0].textContent")
        assert refused == [["tag_foreign_id", "12"], ["frames_stale", "3"]]
    assert browser.complaints == []


def test_no_request_leaves_the_host_and_the_console_stays_empty(shared, browser):
    with RobotOnBus(shared.url, "at_home", PREVIEW=picture(gray_image())):
        for scheme, width in (("light", 1400), ("dark", 390)):
            page = browser.open(shared.of("at_home"), scheme=scheme, width=width)
            page.wait_for_selector("#picture[data-tags='0 1']")
            assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth"), (
                f"{width} px is not enough"
            )
        assert {urlsplit(request).netloc for request in browser.requests} == {shared.host}
    assert browser.complaints == []


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        ({"OBSERVATION": observation(distance_m=math.nan)}, {"distance": DASH, "linear": "+0.321"}),
        ({"COMMAND": command(linear_mps=math.inf)}, {"distance": "1.350", "linear": DASH}),
        ({"STATUS": status(error_m=math.nan, latency_s=math.nan)}, {"distance": "1.350", "latency": DASH}),
        ({"OBSERVATION": observation(tags=0)}, {"distance": "1.350"}),
        ({"OBSERVATION": observation(tags=12)}, {"distance": "1.350"}),
    ],
    ids=["NaN distance", "infinite speed", "NaN status", "0 tags", "12 tags"],
)
def test_odd_numbers_are_dashes_and_the_rest_is_shown(shared, browser, request, message, expected):
    name = "odd_" + re.sub(r"\W", "", request.node.callspec.id).lower()
    with RobotOnBus(shared.url, name, **message, PREVIEW=picture(gray_image())):
        page = browser.open(shared.of(name))
        for name, value in expected.items():
            wait_for_text(page, f"#value-{name}", value)
        tags = " ".join(str(tag.id) for tag in message.get("OBSERVATION", observation()).tags)
        page.wait_for_selector(f"#picture[data-tags='{tags}']", state="attached")
    assert browser.complaints == []


def test_malformed_messages_are_counted_and_the_page_lives_on(shared, browser):
    with RobotOnBus(shared.url, "garbled") as robot:
        page = browser.open(shared.of("garbled"))
        good = status().encode()
        for data in (b"", b"\0" * 7, good[:40], good[:8] + b"\xff" * 900, b"x" * 60000):
            robot.send("STATUS", data)
        for data in (b"", b"nonsense", picture(gray_image(8, 8)).encode()[:30]):
            robot.send("PREVIEW", data)
        page.wait_for_selector("#refused tr[data-counter=view_status]")
        wait_for_text(page, "#refused tr[data-counter=view_status] td", "5")
        robot.messages["COMMAND"] = command(linear_mps=0.111)
        wait_for_text(page, "#value-linear", "+0.111")
    assert browser.complaints == []


def test_a_robot_that_falls_silent_is_old_within_a_second(shared, browser):
    with RobotOnBus(shared.url, "silent", PREVIEW=picture(gray_image())):
        page = browser.open(shared.of("silent"))
        page.wait_for_selector("#picture[data-tags='0 1']")
        # What the page says of the newest message's age at the moment when it stops to call it live.
        page.evaluate(
            """() => {
              window.firstSaid = null;
              const look = () => {
                if (document.body.dataset.live === "live") return;
                window.firstSaid ??= document.getElementById("why").textContent;
              };
              new MutationObserver(look).observe(document.body, { attributes: true });
            }"""
        )
    page.wait_for_selector('body[data-live="silent"]')
    wait_for_text(page, "#headline", "No messages from silent")
    said = re.match(r"the newest is (\d+) ms old", page.evaluate("window.firstSaid"))
    assert said, page.evaluate("window.firstSaid")
    assert 500 < int(said[1]) < 1000
    struck = "() => getComputedStyle(document.querySelector('#tiles dd span')).textDecorationLine"
    assert page.evaluate(struck) == "line-through"
    page.wait_for_selector("#picture-card[data-old]")
    with RobotOnBus(shared.url, "silent"):
        page.wait_for_selector('body[data-live="live"]')
        wait_for_text(page, "#headline", "Following the leader")
        assert page.evaluate(struck) == "none"


def test_a_killed_server_is_named_and_its_successor_found(tmp_path, url, browser):
    with RobotOnBus(url):
        with serving(tmp_path, "robot1", "--lcm-url", url) as server:
            page = browser.open(server.address)
            port = server.host.rsplit(":", 1)[1]
            server.child.process.kill()
            page.wait_for_selector('body[data-link="lost"]')
            wait_for_text(page, "#headline", "Server not reachable")
            assert page.evaluate("document.body.dataset.live") == "never"
        with serving(tmp_path, "robot1", "--lcm-url", url, "--port", port, name="second") as second:
            page.wait_for_selector('body[data-link="open"][data-live="live"]')
            # It has another token: the page has loaded itself anew to get it.
            page.wait_for_function(
                "token => document.querySelector('meta[name=pilotfish-token]').content === token", arg=second.token()
            )


def test_a_second_tab_and_a_reload_show_the_same(shared, browser):
    with RobotOnBus(shared.url, "tabs") as robot:
        first, second = browser.open(shared.of("tabs")), browser.open(shared.of("tabs"), width=390)
        first.reload()
        robot.messages["OBSERVATION"] = observation(distance_m=1.777)
        for page in (first, second):
            page.wait_for_selector('body[data-live="live"]')
            wait_for_text(page, "#value-distance", "1.777")
    assert browser.complaints == []


def test_robots_are_discovered_and_can_be_chosen(tmp_path, url, browser):
    with serving(tmp_path, "--lcm-url", url) as server:
        page = browser.open(server.address, wait=None)
        wait_for_text(page, "#headline", "Waiting for a robot")
        other = RobotOnBus(url, "second_2", COMMAND=command(linear_mps=0.055))
        with RobotOnBus(url), other:
            page.wait_for_selector("nav a")
            assert columns_of(page, "nav a", "e.textContent") == [["robot1"], ["second_2"]]
            page.click("nav a:text('second_2')")
            wait_for_text(page, "#value-linear", "+0.055")
            assert page.inner_text("#name") == "second_2"


def test_a_frame_that_does_not_fit_the_calibration_is_said_with_both_sizes(shared, browser):
    reason = 6  # frame_size_not_calibrated
    messages = {
        "STATUS": status(status=command_t.STATUS_INVALID_INPUT, reason=reason),
        "OBSERVATION": observation(tags=0, detected=False, reason=reason),
        "PREVIEW": picture(gray_image(1280, 720)),
    }
    with RobotOnBus(shared.url, "misfit", **messages):
        page = browser.open(shared.of("misfit"))
        wait_for_text(page, "#lines", "frame 1280 x 720, calibration 640 x 480")
        assert text(page, "#why") == "the frame's size is not the calibration's"
