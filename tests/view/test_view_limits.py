"""Setpoints that a robot would refuse are refused by the page's server, in metres and degrees."""

from __future__ import annotations

import math

import pytest

from pilotfish import core, data
from pilotfish.view.limits import LEAST_M, MOST_BEARING_DEG, MOST_M, SetpointLimits, limits_of
from pilotfish.view.setup import default_setup, load_setup


def test_the_bounds_are_those_of_a_setpoint():
    inside = {"distance_m": (LEAST_M, MOST_M), "bearing_rad": (-math.radians(MOST_BEARING_DEG), math.radians(70.0))}
    for name, (least, most) in inside.items():
        core.Setpoint(**{name: least}), core.Setpoint(**{name: most})
        for beyond in (least - 1e-6, most + 1e-6):
            with pytest.raises(ValueError, match=name):
                core.Setpoint(**{name: beyond})


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ((None, math.radians(80.0)), "bearing: 80° is not within \N{MINUS SIGN}70 to 70°"),
        ((None, math.radians(-70.5)), "bearing: \N{MINUS SIGN}70.5° is not within \N{MINUS SIGN}70 to 70°"),
        ((0.1, None), "distance: 0.1 m is not within 0.4 to 20 m: 0.4 m is the robot's safety.stop_distance_m"),
        ((0.01, 0.0), "distance: 0.01 m is not within 0.4 to 20 m"),
        ((25.0, 0.0), "distance: 25 m is not within 0.4 to 20 m"),
        ((0.4, math.radians(70.0)), ""),
        ((None, math.radians(-70.0)), ""),
    ],
)
def test_what_is_refused_is_said_with_its_bounds(asked, said):
    assert SetpointLimits(stop_distance_m=0.4).refusal(*asked) == said


def test_the_stop_distance_is_the_configured_robots_and_without_one_the_robot_decides():
    configured = load_setup(data.path("config/line.yaml"))
    assert limits_of(configured).distance_m == (configured.stop_distance_m, 20.0)
    assert limits_of(default_setup()).distance_m == (0.05, 20.0)
    assert limits_of(default_setup()).refusal(0.06, None) == ""
