"""What the page says of a request stays true: it ages, and goes when the robot says something else."""

from __future__ import annotations

import pytest
from test_view_page import text, wait_for_text
from view_server import serving, serving_a_bus

from robot_on_bus import NOW_US, RobotOnBus, gray_image, picture, status, with_lists
from scripted_coordinator import ScriptedCoordinator


@pytest.fixture(scope="module")
def answering(tmp_path_factory):
    """A server as `shared`, on a bus of its own: one server watches 16 robots at most."""
    with serving_a_bus(tmp_path_factory.mktemp("answers")) as server:
        yield server


def test_an_answer_says_its_age_and_goes_when_another_page_resumes_the_robot(answering, browser):
    """Page 1: STOP, then Set, which a stopped robot confirms as stopped. Page 2: Resume."""
    with ScriptedCoordinator(answering.url, "two_pages"):
        first, second = browser.open(answering.of("two_pages")), browser.open(answering.of("two_pages"), width=390)
        first.click("#stop")
        first.wait_for_selector("#outcome[data-state=confirmed]")
        first.fill("#distance", "1.25")
        first.click("#set")
        wait_for_text(first, "#outcome", "would keep 1.25 m")
        wait_for_text(first, "#outcome-age", "s ago")
        assert "would keep 1.25 m" in text(first, "#outcome")  # true as long as nobody resumes it
        second.click("#resume")
        wait_for_text(first, "#outcome", "setpoint was confirmed; since then the robot has been resumed")
        assert "keep" not in text(first, "#outcome")
        wait_for_text(second, "#outcome", "keeps 1.25 m")
        first.fill("#distance", "1.5")
        first.click("#set")
        wait_for_text(first, "#outcome", "keeps 1.50 m")
        second.fill("#distance", "1.75")
        second.click("#set")
        wait_for_text(first, "#outcome", "setpoint was confirmed; since then another setpoint has been set")
        assert text(second, "#outcome").count("message") == 1
    assert browser.complaints == []


def test_a_stop_that_was_not_confirmed_is_no_news_of_the_coordinator_that_is_started_then(answering, browser):
    name = "restarted"
    with RobotOnBus(answering.url, name, STATUS=status(session=1)):  # a coordinator that hears nothing
        page = browser.open(answering.of(name))
        page.click("#stop")
        page.wait_for_selector("#outcome[data-state=refused]")
        said = text(page, "#outcome")
        assert "stops were sent" in said and "messages)" not in said  # once is enough
        wait_for_text(page, "#outcome-age", "s ago")
        # It follows on: as long as it is the same coordinator, this is what has to be read.
        assert text(page, "#outcome") == said
    with RobotOnBus(answering.url, name, STATUS=status(session=2)):
        wait_for_text(page, "#outcome", "STOP was not confirmed; since then the coordinator has been started anew")
        assert text(page, "#outcome").endswith("and drives")
        assert text(page, "#stop-note") == "space or Esc"


def test_a_setpoint_beyond_the_bounds_is_refused_in_degrees_and_metres(answering, browser):
    with ScriptedCoordinator(answering.url, "bounds") as robot:
        page = browser.open(answering.of("bounds"))
        for distance, bearing, said in (
            ("1", "80", "bearing: 80° is not within -70 to 70°"),
            ("0.1", "0", "distance: 0.1 m is not within 0.4 to 20 m: 0.4 m is the robot's safety.stop_distance_m"),
        ):
            page.fill("#distance", distance)
            page.fill("#bearing", bearing)
            page.click("#set")
            wait_for_text(page, "#outcome", said)
        assert robot.verdicts == []  # nothing was sent
        assert page.get_attribute("#distance", "min") == "0.4"
        assert page.get_attribute("#bearing", "max") == "70"


def test_a_rule_that_hardly_fired_does_not_stay_lit(answering, browser):
    """0.004 reads as 0.00, which is also what is shown when the robot has been stopped."""
    lit = "[...document.querySelectorAll('#rules td[data-fires]')].map((e) => e.dataset.rule).join()"
    shaded = "[...document.querySelectorAll('#rules td')].filter((e) => e.style.backgroundColor).length"
    with RobotOnBus(answering.url, "rules", STATUS=with_lists(status(), strengths={25: 0.75, 26: 0.004})) as robot:
        page = browser.open(answering.of("rules"))
        page.wait_for_function(f"() => {lit} === 'NZ PS'")
        robot.messages["STATUS"] = with_lists(status(), strengths={25: 0.004})
        page.wait_for_function(f"() => {lit} === ''")
        wait_for_text(page, "#law-point", "no rule fires")
        assert page.evaluate(shaded) == 0


def test_under_a_name_that_nobody_has_the_page_says_who_is_heard(tmp_path, url, browser):
    with serving(tmp_path, "nosuch", "--lcm-url", url) as server, RobotOnBus(url, "robot1"):
        page = browser.open(server.address, wait=None)
        wait_for_text(page, "#headline", "Nothing heard from nosuch")
        wait_for_text(page, "#why", "Heard on this bus: robot1. To watch: pilotfish view robot1")
        server.child.process.kill()
        wait_for_text(page, "#why", "pilotfish stop nosuch")


def test_pictures_that_still_come_are_not_called_old_when_the_coordinator_is_gone(answering, browser):
    with RobotOnBus(answering.url, "widow", IMAGE=picture(gray_image(), jpeg=False)) as robot:
        page = browser.open(answering.of("widow"))
        page.wait_for_selector("#picture[data-tags='0 1']")
        robot.messages = {"IMAGE": picture(gray_image(), jpeg=False, utime=NOW_US + 1)}
        wait_for_text(page, "#why", "numbers, curves and rules are old; the picture is live, from the camera")
        wait_for_text(page, "#picture-note", "live, from the camera; nobody measures in it")
        assert page.get_attribute("#picture-card", "data-old") is None
    wait_for_text(page, "#why", "what is shown is old")
    page.wait_for_selector("#picture-card[data-old]")
