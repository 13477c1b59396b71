"""Whom a robot of a formation follows while its leader is lost: read, checked, expanded, played."""

import math

import numpy as np
import pytest
from formation_files import formation, tree

from pilotfish.coordinator import load_coordinator
from pilotfish.errors import ConfigError
from pilotfish.formation import find_formation, load_formation
from pilotfish.formation.expand import load_expanded
from pilotfish.formation.run import play

# robot1 and robot2 side by side behind the leader, robot3 behind both.
BRANCHES = tree(("leader", 1.2, -18.0), ("leader", 1.2, 18.0), ("robot1", 1.3, 16.0))


def three(**content):
    return formation("tree", tree=BRANCHES, **content)


def test_the_setpoints_behind_the_others_keep_the_robot_in_its_place():
    shape = three(otherwise={"robot3": ["robot2", "leader"]})
    places = shape.stages[0].places
    for watch in shape.otherwise.watches["robot3"]:
        ahead_m, left_m = np.subtract(places[watch.leader], places["robot3"])
        assert watch.distance_m * math.cos(watch.bearing_rad) == pytest.approx(ahead_m)
        assert watch.distance_m * math.sin(watch.bearing_rad) == pytest.approx(left_m)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"otherwise": {"robot9": ["leader"]}}, "otherwise.robot9: 'robot9' follows nobody; these do: robot1, robot2"),
        ({"otherwise": {"leader": ["robot1"]}}, "otherwise.leader: 'leader' follows nobody"),
        ({"otherwise": {"robot3": "leader"}}, "otherwise.robot3: 'leader' is not a list of 1 to 7 robots"),
        ({"otherwise": {"robot3": []}}, "otherwise.robot3: [] is not a list of 1 to 7 robots"),
        ({"otherwise": {"robot3": ["robot4"]}}, "otherwise.robot3[0]: 'robot4' is no robot here; there are: leader"),
        ({"otherwise": {"robot3": ["robot1"]}}, "otherwise.robot3[0]: 'robot1' is its leader already"),
        ({"otherwise": {"robot3": ["robot3"]}}, "otherwise.robot3[0]: 'robot3' is the robot itself"),
        ({"otherwise": {"robot3": ["leader", "leader"]}}, "otherwise.robot3[0]: 'leader' is there twice"),
        ({"otherwise": {"robot2": ["robot1"]}}, "otherwise.robot2[0]: robot2 would watch robot1 at 0.74 m, 90.0 deg"),
        ({"otherwise": {"robot3": [["robot2"]]}}, "otherwise.robot3[0]: '['robot2']' is no robot here"),
        ({"after_lost_s": 0.2}, "after_lost_s: 0.2 is out of range; allowed: 0.3 to 3600"),
        (
            {"after_lost_s": 2.0, "back_after_s": 1.0},
            "back_after_s: 1 is shorter than after_lost_s; allowed: 0 (never)",
        ),
        ({"dropouts": [{"robot": "robot4", "at_s": 1.0}]}, "dropouts[0].robot: 'robot4' is not one of leader, robot1"),
        ({"dropouts": [{"robot": "robot1", "at_s": 40.0}]}, "dropouts[0].at_s: 40 is out of range; allowed: 0 to 30"),
        ({"dropouts": [{"robot": "robot1", "at_s": 30.0}]}, "dropouts[0].at_s: 30 is the end of the run (duration_s)"),
        (
            {"dropouts": [{"robot": "robot1", "at_s": 4.0, "until_s": 4.0}]},
            "dropouts[0].until_s: 4 is not after at_s (4); allowed: more than 4 to 31",
        ),
        (
            {"dropouts": [{"robot": "robot1", "at_s": 4.0, "until_s": 3.0}]},
            "dropouts[0].until_s: 3 is not after at_s (4); allowed: more than 4 to 31",
        ),
        (
            {"dropouts": [{"robot": "robot1", "at_s": 4.0, "until_s": 32.0}]},
            "dropouts[0].until_s: 32 is out of range; allowed: 0 to 31",
        ),
        ({"dropouts": [{"robot": "robot1", "at_s": 1.0}] * 2}, "dropouts[1].robot: 'robot1' drops out twice"),
        (
            {"otherwise": {"robot3": ["leader"]}, "changes": [{"at_s": 5.0, "tree": BRANCHES}]},
            "otherwise: cannot stand beside `changes`",
        ),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(content, said):
    with pytest.raises(ConfigError) as refused:
        three(**content)
    assert said in str(refused.value)


def test_who_is_hidden_behind_the_present_leader_is_no_other_leader():
    with pytest.raises(ConfigError, match=r"otherwise\.robot2\[0\].*hidden behind robot1"):
        formation("chain", otherwise={"robot2": ["leader"]})


def test_expanded_the_coordinators_have_the_alternatives_with_the_others_ids(tmp_path):
    shape = three(otherwise={"robot3": ["robot2", "leader"]}, after_lost_s=0.7, back_after_s=1.5)
    for robot in load_expanded(shape, tmp_path).robots:
        config = load_coordinator(robot.coordinator_file).coordinator
        if robot.name != "robot3":
            assert config.other_leaders == []
            continue
        assert (config.alternatives.after_lost_s, config.alternatives.back_after_s) == (0.7, 1.5)
        kept = shape.otherwise.watches["robot3"]
        assert [other.distance_m for other in config.other_leaders] == pytest.approx([each.distance_m for each in kept])
        assert [other.bearing_rad for other in config.other_leaders] == pytest.approx([w.bearing_rad for w in kept])
        ids = [[tag.id for tag in other.leader.tags] for other in config.other_leaders]
        assert ids == [[20, 21, 22], [0, 1, 2]]  # robot2 is the third robot


def test_while_the_leader_in_front_cannot_be_seen_it_drives_on_and_everybody_stands():
    """Nobody sees the leader from 3 s to 5 s. Its followers stop by themselves, robot3 behind robot1, which it sees;
    the leader drives on at 0.2 m/s for 2 s, 0.4 m, and is followed again."""
    dropout = {"robot": "leader", "at_s": 3.0, "until_s": 5.0}
    run = play(three(otherwise={"robot3": ["robot2"]}, dropouts=[dropout], duration_s=15.0, frame_rate_hz=15.0))
    for robot in run.recordings.values():
        standing = (robot.time_s > 4.2) & (robot.time_s < 5.0)
        assert np.ptp(robot.x_m[standing]) < 0.005
        assert abs(robot.distance_error_m[-1]) < 0.02
    # The leader was 1.2 m away at -18 deg, and draws away straight ahead: by 2 s at 0.2 m/s, less what the follower
    # rolls on, at most (0.1 s of hold, 0.033 s latency, 0.1 s lag, 0.1 s of braking) at 0.2 m/s = 0.067 m.
    ahead_m, aside_m = 1.2 * math.cos(math.radians(18.0)), 1.2 * math.sin(math.radians(18.0))
    first = run.recordings["robot1"]
    away_m = first.true_distance_m[np.searchsorted(first.time_s, 5.0 - 1e-9)]
    assert math.hypot(ahead_m + 0.4 - 0.07, aside_m) < away_m < math.hypot(ahead_m + 0.4, aside_m)
    assert run.followed["robot3"] == [(0.0, "robot1")]  # robot1 is seen all the time


def test_in_the_shipped_one_the_follower_takes_the_stand_in_and_returns():
    shape = load_formation(find_formation("stand_in"))
    (dropout,) = shape.dropouts
    run = play(shape)
    (_, first), (away_s, second), (back_s, third) = run.followed["robot3"]
    assert (first, second, third) == ("robot1", "robot2", "robot1")
    period_s = 1.0 / shape.frame_rate_hz
    # It was seen last one picture before at_s; measurements are drawn, so that it is seen again at until_s.
    assert away_s == pytest.approx(dropout.at_s + shape.otherwise.after_lost_s - period_s, abs=period_s + 1e-6)
    assert back_s == pytest.approx(dropout.until_s + shape.otherwise.back_after_s, abs=period_s + 1e-6)
    # In its place at the end of both, to the errors of bearing that it has while its heading settles.
    robot = run.recordings["robot3"]
    for until_s in (dropout.until_s, shape.duration_s):
        row = np.searchsorted(robot.time_s, until_s) - 1
        behind_m = run.recordings["robot2"].x_m[row] - robot.x_m[row]
        places = shape.stages[0].places
        assert behind_m == pytest.approx(places["robot2"][0] - places["robot3"][0], abs=0.02)
    assert all(since == [(0.0, leader)] for (robot, since), leader in
               zip(run.followed.items(), shape.leaders.values(), strict=True) if robot != "robot3")  # fmt: skip
