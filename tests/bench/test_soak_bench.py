"""The soak runs, and finds what it looks for."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "bench" / "soak"))

import fault_kinds  # noqa: E402
import goals  # noqa: E402
import pictures  # noqa: E402
import run  # noqa: E402
from census import Census  # noqa: E402
from robot import Robot  # noqa: E402

RATE_HZ = 12.0
# One of each sort: of the camera, of its stamps, of the bus, of other senders, and those after which it waits a second.
KINDS = ["gray", "frozen", "cut-off-jpeg", "wild-stamps", "clock-hour", "fragments", "liblcm-killer", "forgeries"]
KINDS += ["stop-resume", "second-coordinator"]


def test_two_robot_minutes_with_a_fault_every_ten_seconds_break_nothing(tmp_path):
    faults = [word for kind in KINDS for word in ("--fault", kind)]
    command = [sys.executable, ROOT / "bench" / "soak", "--hours", "0.033", "--out", tmp_path, *faults]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads((tmp_path / "soak.json").read_text())
    assert found["violations"] == []
    assert len(found["played"]) == 12  # 118.8 s, one every ten
    assert {played["kind"] for played in found["played"]} <= set(KINDS)
    assert all(played["recovery_s"] <= 1.0 for played in found["played"] if not played["disturbed"])
    for census in found["census"].values():
        assert len(set(census["descriptors"])) == len(set(census["threads"])) == 1
    # Memory has ten minutes to settle, so two say nothing about it; everything else is met.
    assert {goal["met"] for goal in found["goals"]} == {True, None}
    assert (tmp_path / "soak.png").stat().st_size > 0


def test_every_fault_is_drawn_within_the_first_ten_minutes():
    shares = [fault.share for fault in fault_kinds.FAULTS.values()]
    assert sum(shares) * run.EVERY_S <= 600.0


def test_a_robot_that_drives_on_without_a_good_picture_breaks_the_rule(tmp_path, monkeypatch):
    """The leader is in the pictures, but they do not count as good: so it drives on, and must be found out."""

    def good_pictures_that_do_not_count(robot, rng, duration_s):
        for _ in range(5):  # 5 / 12 s
            robot.show(robot.pictures.good[robot.frames % len(robot.pictures.good)])

    sly = fault_kinds.Fault("a fault that is none", good_pictures_that_do_not_count)
    monkeypatch.setitem(fault_kinds.FAULTS, "gray", sly)
    with Robot(tmp_path, RATE_HZ, pictures.render(RATE_HZ)) as robot:
        found = run.soak(robot, run.EVERY_S, 1, ["gray"], lambda soak: None)
    # The first of the five is 83 ms behind the last good one, which is allowed; the others are too old.
    assert len(found.violations) == 4
    assert found.violations[0].startswith("gray: tracking on a measurement 0.167 s old")
    (rule,) = [goal for goal in goals.goals(found) if "rule" in goal.words]
    assert rule.met is False


def test_a_process_that_dies_ends_the_soak_with_what_it_said(tmp_path):
    with Robot(tmp_path, RATE_HZ, pictures.render(RATE_HZ)) as robot:
        robot.children["base"].process.kill()
        robot.children["base"].process.wait()
        with pytest.raises(Exception, match="base: ended with -9"):
            run.soak(robot, run.EVERY_S, 1, ["gray"], lambda soak: None)


def day_of(rss_mb):
    """A census every 10 s of the memory that the function says, at so many seconds."""
    census = Census()
    for k in range(8640):
        census.at_s.append(10.0 * k)
        census.rss_kb.append(round(1024 * rss_mb(10.0 * k)))
        census.descriptors.append(14)
        census.threads.append(6)
    return census


def memory_goals(census):
    soak = run.Soak(RATE_HZ, census={"coordinator": census}, ended={"coordinator": 0})
    return [goal.met for goal in goals.goals(soak) if "memory" in goal.words and goal.goal != "-"]


def test_a_leak_misses_the_goal_and_what_is_held_for_a_while_does_not():
    # 3 MB for half of every minute, from the first hour to the last; and what was taken in the first ten minutes.
    assert memory_goals(day_of(lambda t: 100 + 3 * (t % 60 >= 30) + min(t, 600) / 100)) == [True] * 4
    # 1.5 MB a day above that: from the first hour to the last it is 23 - 1/6 hours, 1.5 x 22.83 / 24 = 1.43 MB.
    assert memory_goals(day_of(lambda t: 100 + 3 * (t % 60 >= 30) + 1.5 * t / 86400)) == [False] * 4


@pytest.mark.parametrize(("recovery_s", "met"), [(1.0, True), (13 / 12, False)])
def test_a_recovery_of_more_than_a_second_misses_the_goal(recovery_s, met):
    played = run.Played("gray", 0.0, 1.0, True, recovery_s, 0.0, False)
    soak = run.Soak(RATE_HZ, played=[played])
    assert goals.goals(soak)[0].met is met


def test_an_unknown_fault_is_refused(tmp_path):
    command = [sys.executable, ROOT / "bench" / "soak", "--fault", "everything", "--out", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert "clock-hour" in done.stderr
