"""Who watches whom: the nearest robot in front that is seen."""

import itertools
import math

import pytest
from formation_files import formation, tree

from pilotfish.errors import ConfigError
from pilotfish.formation.watching import Bounds, choose


def test_in_a_wedge_each_robot_watches_the_one_before_it_on_its_arm():
    wedge = formation("wedge", robots=7, angle_deg=18.0)
    arms = ["leader", "robot1", "robot3", "robot5"], ["leader", "robot2", "robot4", "robot6"]
    assert wedge.leaders == {robot: before for arm in arms for before, robot in itertools.pairwise(arm)}


def test_in_a_column_everybody_watches_the_one_before():
    assert list(formation("column", robots=4).leaders.values()) == ["leader", "robot1", "robot2"]


def test_the_rear_of_a_diamond_watches_the_left_of_two_that_are_equally_near():
    assert formation("diamond", robots=4, spacing_m=1.1).leaders["robot3"] == "robot1"


def test_robots_side_by_side_watch_the_leader_in_front_for_they_cannot_see_each_other():
    assert set(formation("line_abreast", robots=5, spacing_m=0.8).leaders.values()) == {"leader"}


def test_a_nearer_robot_that_is_outside_the_picture_is_passed_over():
    """In an echelon of 20 degrees and a change to 25: both are seen. The rule itself: robot2 of this wedge is nearer to
    robot1 (side by side) than to the leader."""
    wedge = formation("wedge", spacing_m=1.0, angle_deg=18.0)
    beside_m = 2 * math.sin(math.radians(18.0))
    assert beside_m < 1.0
    assert wedge.leaders["robot2"] == "leader"


def test_a_nearer_robot_that_a_later_shape_hides_is_passed_over_for_one_that_is_seen_in_all():
    """robot1 is at 1.17 m, 20 degrees, and then straight to the left; the leader is 2 m ahead all the time."""
    outlook, bounds = formation("chain").outlook, Bounds(0.5, 5.0, "")
    first = {"leader": (0.0, 0.0), "robot1": (-0.9, 0.4), "robot2": (-2.0, 0.0)}
    beside = {**first, "robot1": (-2.0, 1.0)}
    assert choose(outlook, bounds, [first], "robot2") == "robot1"
    assert choose(outlook, bounds, [first, beside], "robot2") == "leader"


def test_who_can_be_seen_in_the_first_shape_alone_is_not_watched():
    """In the column robot2 sees robot1 alone. In a star it would have to watch the leader."""
    star = {"at_s": 5.0, "shape": "star", "spacing_m": 2.0, "angle_deg": 18.0}
    with pytest.raises(ConfigError, match="robot2"):
        formation("column", changes=[star])
    # Two that follow the leader in a wedge and in a star: nothing hinders them.
    changed = formation("wedge", angle_deg=18.0, changes=[{**star, "angle_deg": 22.0}])
    assert changed.leaders == {"robot1": "leader", "robot2": "leader"}


def test_a_change_keeps_what_it_does_not_say():
    changed = formation(
        "wedge", angle_deg=18.0, changes=[{"at_s": 5.0, "spacing_m": 1.4}, {"at_s": 9.0, "angle_deg": 20}]
    )
    assert [stage.shape.spacing_m for stage in changed.stages] == [1.0, 1.4, 1.4]
    assert [round(math.degrees(stage.shape.angle_rad)) for stage in changed.stages] == [18, 18, 20]
    assert changed.stages[1].watches["robot1"].distance_m == pytest.approx(1.4)


WRONG = [
    ("wedge", {"angle_deg": 35.0}, "angle_deg", "-35.0 deg: outside the picture; .* from -2[67]"),
    ("wedge", {"robots": 1}, "robots", "1 is not allowed: a whole number from 2 to 25"),
    ("wedge", {"robots": 2.5}, "robots", "2.5 is not allowed"),
    ("wedge", {"robots": True}, "robots", "True is not allowed"),
    ("wedge", {"spacing_m": float("nan")}, "spacing_m", "nan is not a number; allowed: 0.1 to 20"),
    ("wedge", {"spacing_m": "wide"}, "spacing_m", "'wide' is not a number"),
    ("wedge", {"spacng_m": 1.0}, "spacng_m", "did you mean spacing_m"),
    ("wedge", {"depth_m": 1.0}, "depth_m", "is not a key here"),
    ("wegde", {}, "shape", "did you mean wedge"),
    ("column", {"spacing_m": 0.4}, "spacing_m", r"0.40 m apart; allowed: 0.61 m or more"),
    ("column", {"spacing_m": 6.0}, "spacing_m", "farther than 5.26 m"),
    ("diamond", {"robots": 5}, "robots", "allowed: 4, 9, 16, 25"),
    ("line_abreast", {"robots": 6, "depth_m": 1.0}, "depth_m", "outside the picture"),
    ("star", {"robots": 4}, "angle_deg", "so that both can turn"),
    ("tree", {"tree": []}, "tree", "is missing"),
    ("tree", {"tree": tree(("leader", 1.0, 0.0), ("leader", 2.0, 0.0))}, "tree[1].bearing_deg", "hidden behind robot1"),
    ("tree", {"tree": tree(("leader", 1.0, 40.0))}, "tree[0].bearing_deg", "outside the picture"),
    ("tree", {"tree": tree(("leader", 6.0, 0.0))}, "tree[0].distance_m", "farther than"),
    ("tree", {"tree": tree(("robot1", 1.0, 0.0))}, "tree", "not before it"),
    ("tree", {"robots": 5, "tree": tree(("leader", 1.0, 0.0))}, "tree", "need 4 branches"),
    ("chain", {"changes": [{"at_s": 99.0}]}, "changes[0].at_s", "allowed: 0.1 to 30"),
    ("chain", {"changes": [{"at_s": 0.0}]}, "changes[0].at_s", "out of range"),
    ("chain", {"changes": [{"at_s": 9.0, "over_s": 3.0}, {"at_s": 10.0}]}, "changes[1].at_s", "allowed: 12 to 30"),
    ("chain", {"changes": [{"at_s": 9.0, "spacing": 3.0}]}, "changes[0].spacing", "did you mean spacing_m"),
    ("chain", {"changes": 3}, "changes", "3 is not a list"),
    ("chain", {"drive": 3}, "drive", "is not a mapping"),
    ("chain", {"coordinator": "nowhere.yaml"}, "coordinator", "there is no file"),
    ("chain", {"name": "two words"}, "name", "not one word"),
]


@pytest.mark.parametrize(("shape", "content", "key", "words"), WRONG, ids=[f"{s} {k}" for s, _, k, _ in WRONG])
def test_what_cannot_be_is_refused_with_file_key_and_what_is_allowed(shape, content, key, words):
    with pytest.raises(ConfigError, match=words) as refused:
        formation(shape, **content)
    assert refused.value.key == key
    assert str(refused.value).startswith(f"my_formation.yaml: {key}: ")


def test_a_change_that_gives_a_robot_another_leader_is_refused():
    changes = [{"at_s": 5.0, "shape": "star", "spacing_m": 2.5, "angle_deg": 18.0}]
    with pytest.raises(ConfigError, match=r"changes\[0\].shape: star lets robot2 follow leader, but it follows robot1"):
        formation("chain", changes=changes)
