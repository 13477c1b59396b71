"""Odometry and a leader's announcements, with the real programs on a real bus; and the latency they measure."""

import json
import math
import time

import numpy as np
import pytest
from edited_scenario import edited_scenario
from onboard import Onboard, same_in_process

from pilotfish import core
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.over_lcm import run_over_lcm
from pilotfish.lcmtypes.bot_core.pose_t import pose_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.motion_t import motion_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t
from scenes import leader_pictures


def weak_drive(content):
    """Wheels that speed up at 0.4 m/s2, where their coordinator thinks that they do at 1."""
    content["robots"][1]["drive"]["max_linear_acceleration_mps2"] = 0.4


def feed_odometry(world, robot, driver):
    driver.set_ego_motion(world.utime, world.state(robot).twist)


def test_a_coordinator_with_odometry_drives_as_the_same_code_in_one_process_and_not_as_without(tmp_path):
    scenario = edited_scenario(tmp_path, "line", weak_drive)
    options = {"profile": "anticipate", "duration_s": 3.0}
    over_lcm = run_over_lcm(scenario, coordinator_options=["--odometry", "pose"], **options)
    inside = run_in_process(scenario, feed=feed_odometry, **options).recordings["robot1"]
    outside, reports = over_lcm.recordings["robot1"], over_lcm.reports["robot1"]
    # Turned into the world's frame for the wire and back, a speed comes with another last bit.
    assert outside.command_linear_mps == pytest.approx(inside.command_linear_mps, abs=1e-9)
    assert outside.command_angular_radps == pytest.approx(inside.command_angular_radps, abs=1e-9)
    # The first picture sets the time: odometry counts from the second on.
    assert [report.ego_motion for report in reports] == ["commanded"] + ["odometry"] * (len(reports) - 1)
    without = run_in_process(scenario, **options).recordings["robot1"]
    assert np.abs(without.command_linear_mps - outside.command_linear_mps).max() > 0.01


def stops_after_three_seconds(content):
    content["duration_s"] = 4.5
    content["robots"][0]["trajectory"]["stop_time_s"] = 3.0


def test_behind_a_leader_that_announces_its_stop_the_robot_comes_less_near(tmp_path):
    """One camera latency of 1/30 s earlier at 0.2 m/s: 6.7 mm, from the real programs, pictures and bus."""
    scenario = edited_scenario(tmp_path, "stop_dead", stops_after_three_seconds)
    listening = ["--leader-intent-from", "leader"]
    with_intent = run_over_lcm(
        scenario, profile="anticipate", coordinator_options=listening, sim_options=["--publish-intent"]
    )
    without_intent = run_over_lcm(scenario, profile="anticipate", sim_options=["--publish-intent"])
    closest = {
        name: run.recordings["robot1"].distance_error_m[run.recordings["robot1"].time_s >= 3.0].max()
        for name, run in (("with_intent", with_intent), ("without_intent", without_intent))
    }
    assert closest["without_intent"] - closest["with_intent"] == pytest.approx(0.2 / 30, abs=0.002)
    uses = [report.leader_intent for report in with_intent.reports["robot1"]]
    assert 1 <= uses.count("used") <= 2 and uses[-1] == "agrees"
    assert {report.leader_intent for report in without_intent.reports["robot1"]} == {"silent"}


class Listening(Onboard):
    """Also hears what the coordinator says of itself."""

    def __init__(self, folder, *options, **keywords):
        super().__init__(folder, *options, **keywords)
        self.statuses = []
        self.bus.subscribe("ROBOT1_STATUS", lambda _, data: self.statuses.append(status_t.decode(data)))

    def status_of(self, utime):
        self.listen_until(lambda: any(s.utime == utime for s in self.statuses), "its status")
        return next(s for s in self.statuses if s.utime == utime)


def test_the_status_says_how_the_leader_moves_and_how_far_that_is_trusted(tmp_path):
    with Listening(tmp_path) as onboard:
        frames = leader_pictures(10)
        for frame in frames:
            assert onboard.answer_to(frame).status == command_t.STATUS_TRACKING
        status = onboard.status_of(frames[-1].utime)
    report = json.loads(onboard.child.stdout().splitlines()[9])
    assert 0.0 < status.feed_forward_weight <= 1.0
    for key in ("feed_forward_weight", "leader_radial_mps", "leader_tangential_mps", "leader_turn_rate_radps"):
        assert getattr(status, key) == report[key]
    assert (status.ego_motion, status.leader_intent) == (status_t.EGO_MOTION_COMMANDED, status_t.LEADER_INTENT_SILENT)
    assert status.configured_latency_s == pytest.approx(1 / 30)
    # These pictures carry a time of their own: only the way from their arrival can be measured.
    assert not status.latency_from_exposure and not report["latency_from_exposure"]
    assert 0.0 < status.latency_s < 10.0


def test_the_latency_from_exposure_to_command_is_published_and_a_wrong_one_named_once(tmp_path):
    """Stamped by this host's clock 80 ms ago, the pictures are at least 80 ms old when they are answered; configured
    are 33 ms, and the difference is more than one period of 33 ms."""
    image = leader_pictures(1)[0].image
    with Listening(tmp_path, simulated=False) as onboard:
        for _ in range(40):
            answered = onboard.answer_to(core.Frame(image, utime=time.time_ns() // 1000 - 80_000))
        status = onboard.status_of(answered.utime)
    assert status.latency_from_exposure
    assert 0.080 <= status.latency_s < 0.5
    said = [line for line in onboard.child.stderr().splitlines() if "control.drive.latency_s" in line]
    assert len(said) == 1 and "says 33 ms" in said[0]


def test_what_it_is_about_to_drive_is_announced_for_when_it_will_have_taken_effect(tmp_path):
    """One latency (1/30 s) and one lag (0.1 s) after the picture; a picture without a leader announces zero at once."""
    frames = leader_pictures(4)
    blank = core.Frame(np.full_like(frames[0].image, 128), utime=frames[-1].utime + 400_000)
    announced = []
    with Listening(tmp_path, "--publish-intent") as onboard:
        onboard.bus.subscribe("ROBOT1_MOTION", lambda _, data: announced.append(motion_t.decode(data)))
        answers = [onboard.answer_to(frame) for frame in (*frames, blank)]
        onboard.listen_until(lambda: len(announced) >= len(answers), "what it announces")
    ahead_us = round(1e6 * (1 / 30 + 0.1))
    expected = [frame.utime + ahead_us for frame in frames] + [blank.utime]
    assert [said.utime for said in announced] == pytest.approx(expected, abs=1)
    assert [said.linear_mps for said in announced] == [answer.linear_mps for answer in answers]
    assert announced[-1].linear_mps == 0.0 and answers[0].linear_mps > 0.0


def test_odometry_that_cannot_be_used_is_counted_and_changes_nothing(tmp_path):
    frames = leader_pictures(8)
    expected = [result.command for result in same_in_process(frames)]
    with Listening(tmp_path, "--odometry", "pose") as onboard:
        answers = []
        for frame in frames:
            for utime, speed in ((frame.utime, math.nan), (frame.utime + 10_000_000, 0.1), (frame.utime, 5.0)):
                pose = pose_t()
                pose.utime, pose.vel, pose.orientation = utime, [speed, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
                onboard.bus.publish("ROBOT1_POSE", pose.encode())
            answers.append(onboard.answer_to(frame))
        rejected = {c.name: c.count for c in onboard.status_of(frames[-1].utime).rejected}
    assert [core.Twist(linear_mps=a.linear_mps, angular_radps=a.angular_radps) for a in answers] == expected
    assert rejected["pose_not_finite"] == 8
    assert rejected["ego_motion_unusable"] == 16


def test_without_configuration_a_coordinator_receives_neither_odometry_nor_leader_intents(tmp_path):
    """ROBOT1_POSE is the truth in simulation, and not an input."""
    with Listening(tmp_path) as onboard:
        broken = pose_t()
        broken.vel = [math.nan] * 3
        for channel in ("ROBOT1_POSE", "LEADER_MOTION", "ROBOT1_MOTION"):
            onboard.bus.publish(channel, broken.encode())
        frame = leader_pictures(1)[0]
        onboard.answer_to(frame)
        names = {c.name for c in onboard.status_of(frame.utime).rejected}
    assert not names & {"pose_not_finite", "motion_corrupt", "ego_motion_unusable", "leader_intent_unusable"}
