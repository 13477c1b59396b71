"""A leader whose tags vanish, and another robot in view: the follower stops, and goes on behind that one."""

import numpy as np
import pytest
import yaml
from edited_scenario import edited_scenario

from pilotfish import data as shipped
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.over_lcm import run_over_lcm

HIDDEN_S, AFTER_LOST_S, MAX_AGE_S = 2.0, 0.5, 0.1
DISTANCE_M = 1.2
PERIOD_S = 1.0 / 30.0
LEADERS = shipped.path("leaders/three_faces.yaml").parent


def scenario(folder, hidden_until_s=1e6, duration_s=7.0, back_after_s=0.0):
    """robot1 follows a leader that is hidden from 2 s on; 0.4 m to the left of it and 0.5 m ahead drives another robot,
    at the same speed, with other tags."""
    original = shipped.path("config/coordinator.yaml")
    config = yaml.safe_load(original.read_text())
    config["camera"]["calibration"] = str((original.parent / config["camera"]["calibration"]).resolve())
    config["fuzzy"] = str((original.parent / config["fuzzy"]).resolve())
    config["leader"] = str(LEADERS / "three_faces.yaml")
    config["alternatives"] = {
        "after_lost_s": AFTER_LOST_S,
        "back_after_s": back_after_s,
        "leaders": [
            {"leader": str(LEADERS / "three_faces_third.yaml"), "distance_m": 1.0},  # who is not there
            {"leader": str(LEADERS / "three_faces_second.yaml"), "distance_m": DISTANCE_M},
        ],
    }
    (folder / "robot1.yaml").write_text(yaml.safe_dump(config))

    def change(content):
        content["duration_s"] = duration_s
        leader, follower = content["robots"]
        leader["body"] |= {"hidden_from_s": HIDDEN_S, "hidden_until_s": hidden_until_s}
        other = {
            "name": "other",
            "start": {"x_m": 0.5, "y_m": 0.4, "heading_deg": 0.0},
            "trajectory": dict(leader["trajectory"]),
            "body": {
                **{key: value for key, value in leader["body"].items() if not key.startswith("hidden")},
                "leader": str(LEADERS / "three_faces_second.yaml"),
            },
        }
        follower["coordinator"] = str(folder / "robot1.yaml")
        content["robots"] = [leader, other, follower]

    return edited_scenario(folder, "vanish", change)


@pytest.fixture(scope="module")
def over_lcm(tmp_path_factory):
    return run_over_lcm(scenario(tmp_path_factory.mktemp("alternatives")), profile="anticipate")


def times(reports):
    return np.array([report.utime for report in reports]) * 1e-6 - reports[0].utime * 1e-6


def test_it_stands_until_the_other_one_is_followed_and_drives_on_behind_that(over_lcm):
    reports, recording = over_lcm.reports["robot1"], over_lcm.recordings["robot1"]
    time_s = times(reports)
    leader = np.array([report.leader_index for report in reports])
    # Seen last one picture before it vanishes; unseen for after_lost_s by then, to one picture.
    at_s = time_s[np.argmax(leader == 2)]
    assert at_s == pytest.approx(HIDDEN_S - PERIOD_S + AFTER_LOST_S, abs=PERIOD_S + 1e-6)
    assert set(leader[time_s < at_s]) == {0} and set(leader[time_s >= at_s]) == {2}
    assert [report.leader_changes for report in reports] == [int(each == 2) for each in leader]
    for report, now_s in zip(reports, time_s, strict=True):
        if HIDDEN_S + MAX_AGE_S < now_s < at_s - 1e-6:
            assert (report.status, report.linear_mps, report.angular_radps) == ("lost", 0.0, 0.0)
        elif now_s >= at_s - 1e-6:
            assert report.status == "tracking" and set(report.tag_ids) <= {10, 11, 12}
    assert "another leader" in reports[int(np.argmax(leader == 2))].reason
    # Behind the other robot, whose place is that of its own trajectory: 0.5 m ahead, 0.4 m to the left of the leader.
    x_m, y_m = recording.leader_x_m + 0.5, recording.leader_y_m + 0.4
    distance_m = np.hypot(x_m - recording.x_m, y_m - recording.y_m)
    assert distance_m[-1] == pytest.approx(DISTANCE_M, abs=0.03)
    assert reports[-1].distance_m == pytest.approx(distance_m[-1], abs=2e-3)


def test_over_lcm_it_decides_what_it_decides_in_process(over_lcm, tmp_path):
    in_process = run_in_process(scenario(tmp_path, duration_s=3.0), profile="anticipate").reports["robot1"]
    for a, b in zip(over_lcm.reports["robot1"], in_process, strict=False):
        assert (a.utime, a.leader_index, a.status, a.linear_mps) == (b.utime, b.leader_index, b.status, b.linear_mps)


def test_it_returns_to_the_first_leader_once_that_was_in_view_for_the_whole_time(tmp_path):
    back_s, after_s = 4.0, 0.6
    run = run_in_process(
        scenario(tmp_path, hidden_until_s=back_s, back_after_s=after_s, duration_s=5.6), profile="anticipate"
    )
    reports = run.reports["robot1"]
    time_s, leader = times(reports), np.array([report.leader_index for report in reports])
    at_s = time_s[np.flatnonzero(leader == 2)[-1] + 1]
    # A whole picture is searched for it twice a second, and then it must be seen for the whole time.
    assert back_s + after_s - 1e-6 <= at_s <= back_s + 0.5 + after_s + 2 * PERIOD_S
    assert set(leader[time_s >= at_s - 1e-6]) == {0} and reports[-1].leader_changes == 2
    # It drives all the while: its new leader is measured in the picture in which it is taken.
    before, after = (report.linear_mps for report in reports[np.flatnonzero(time_s >= at_s - 1e-6)[0] - 1 :][:2])
    assert before > 0.1 and abs(after - before) <= 1.0 * PERIOD_S + 1e-9
