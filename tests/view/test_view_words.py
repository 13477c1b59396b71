"""What the page says of a status: plain words, with numbers."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from pilotfish import data
from pilotfish.view import words
from pilotfish.view.messages import STATUS_NAMES
from pilotfish.view.setup import default_setup, load_setup

CONFIGURED, BARE = load_setup(data.path("config/line.yaml")), default_setup()
GUIDE = Path(__file__).parents[2] / "docs" / "operating-guide.md"


def status(name="tracking", reason="none", **values):
    said = {"status": name, "reason": reason, "text": reason, "setpoint_distance_m": 1.1, "setpoint_bearing_rad": 0.2}
    return said | values


def seen(ids=(0, 1, 2), detected=True):
    return {
        "detected": detected,
        "distance_m": 1.5,
        "bearing_rad": math.radians(-10),
        "reprojection_error_px": 0.25,
        "tags": [{"id": number} for number in ids],
    }


def describe(*arguments, setup=CONFIGURED, picture_size=None, last_seen_s=None, risen=()):
    return words.describe(*arguments, setup, picture_size=picture_size, last_seen_s=last_seen_s, risen=dict(risen))


@pytest.mark.parametrize("name", STATUS_NAMES)
@pytest.mark.parametrize("observation", [None, seen(), seen(ids=()), seen(detected=False)], ids=str)
@pytest.mark.parametrize("setup", [CONFIGURED, BARE], ids=["configured", "bare"])
def test_every_status_has_a_headline_of_its_own_and_never_says_none_or_nan(name, observation, setup):
    nothing = status(name, setpoint_distance_m=None, setpoint_bearing_rad=None)
    for said in (describe(status(name), observation, setup=setup), describe(nothing, observation, setup=setup)):
        assert said["headline"] == words.HEADLINES[name][0]
        assert not re.search(r"\bNone\b|\bnan\b|\binf\b", " ".join([said["headline"], *said["lines"]]))


def test_only_following_is_good_and_a_status_of_another_version_is_not():
    tones = {name: describe(status(name), seen())["tone"] for name in STATUS_NAMES}
    assert [name for name, tone in tones.items() if tone == "good"] == ["tracking"]
    assert describe(status("unknown (9)"), seen())["tone"] == "bad"


@pytest.mark.parametrize(
    ("ids", "expected"),
    [([4], "id 4"), ([2, 0, 1], "ids 0 to 2"), ([0, 1], "ids 0, 1"), ([0, 3, 7], "ids 0, 3, 7"), ([1, 1], "id 1")],
)
def test_ids_are_named_as_one_would(ids, expected):
    assert words.ids_text(ids) == expected


def test_a_side_needs_no_sign():
    sides = [words.side(math.radians(degrees)) for degrees in (10, -10, 0, 0.01)]
    assert sides == ["10.0° to the left", "10.0° to the right", "straight ahead", "straight ahead"]


@pytest.mark.parametrize(
    ("reason", "line"),
    [
        ("frame_size_not_calibrated", "frame 1280 x 720, calibration 640 x 480"),
        ("no_tag_of_the_leader", "the body has ids 0 to 2"),
        ("pose_refused", "reprojection errors above 3 px are refused"),
        ("tag_refused", "decision margins below 20 gray levels are refused"),
        ("frame_stale", "pictures older than 100 ms are refused"),
    ],
)
def test_a_reason_comes_with_the_numbers_of_the_configuration(reason, line):
    assert line in describe(status("lost", reason), seen(detected=False), picture_size=(1280, 720))["lines"]
    assert line not in describe(status("lost", reason), seen(detected=False), setup=BARE)["lines"]


def test_a_robot_that_coasts_says_for_how_long_it_has_seen_nothing():
    lines = describe(status("coasting"), seen(detected=False), last_seen_s=0.066)["lines"]
    assert lines[0] == "last measured 66 ms ago; after 100 ms the robot stands still"


def test_a_robot_that_was_stopped_has_no_second_reason_to_stand():
    said = describe(status("stopped", "stop_requested"), seen(detected=False), last_seen_s=4.1)
    assert "last measured 4.1 s ago" in said["lines"]
    assert not any("stands still" in line for line in said["lines"])


def test_of_many_counters_those_that_rise_fastest_are_said():
    risen = {"pose": 1, "tag_margin": 30, "tag_residual": 4, "frames_stale": 2, "unheard_of": 99}
    lines = describe(status("lost"), None, risen=risen)["lines"]
    said = [line for line in lines if line.startswith("in the last second")]
    assert [int(re.search(r": (\d+) x", line)[1]) for line in said] == [30, 4, 2]


def test_every_counter_that_has_words_is_one_of_the_operating_guides():
    documented = set(re.findall(r"`([a-z_]+)`", GUIDE.read_text(encoding="utf-8")))
    assert set(words.COUNTER_WORDS) - documented == set()


def test_every_counter_of_the_wheels_that_has_words_is_one_of_the_operating_guides():
    table = GUIDE.read_text().partition("| counter in `ROBOT1_BASE` | meaning |")[2].partition("\n\n")[0]
    assert set(words.BASE_COUNTER_WORDS) == set(
        re.findall(
            r"`([a-z]\w+_\w+)`", "".join(line.split("|")[1] for line in table.splitlines() if line.count("|") > 2)
        )
    )
