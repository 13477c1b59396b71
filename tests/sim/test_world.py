"""Robots, cameras and commands in one world."""

import itertools
import math

import numpy as np
import pytest

from pilotfish import core, sim
from pilotfish import data as shipped
from pilotfish.core import Twist


def scenario(name="line", **changes):
    loaded = sim.load_scenario(shipped.path(f"scenarios/{name}.yaml"))
    for key, value in changes.items():
        setattr(loaded, key, value)
    return loaded


def with_robot(loaded, name, change):
    """The scenario with `change(robot)` done to one robot."""
    robots = loaded.robots
    change(next(robot for robot in robots if robot.name == name))
    loaded.robots = robots
    return loaded


def pictures(world, robot, count, rate_hz=30.0):
    frames = []
    for k in range(count):
        world.advance_to(k / rate_hz)
        frames.append(world.capture(robot))
    return frames


def test_the_same_seed_and_commands_give_the_same_bytes():
    def run(seed):
        world = sim.World(scenario(seed=seed))
        seen = []
        for k in range(8):
            world.advance_to(k / 30)
            seen.append(world.capture("robot1").image.tobytes())
            world.command("robot1", Twist(linear_mps=0.3, angular_radps=-0.5), (k + 1) / 30)
        return seen

    assert run(5) == run(5)
    assert run(5) != run(6)


def test_taking_a_picture_twice_or_not_at_all_changes_no_other():
    careful, careless = sim.World(scenario()), sim.World(scenario())
    for world in (careful, careless):
        world.advance_to(1 / 30)
    careful.capture("robot1")
    assert careful.capture("robot1").image.tobytes() == careless.capture("robot1").image.tobytes()


def test_what_one_robot_sees_does_not_depend_on_who_else_looks():
    star = scenario("star")
    alone = scenario("star")
    alone.robots = [robot for robot in alone.robots if robot.name != "robot2"]
    # robot2 stands beside robot1 and outside its picture.
    assert sim.World(star).capture("robot1").image.tobytes() == sim.World(alone).capture("robot1").image.tobytes()


def test_time_on_the_frames_clock_begins_after_zero_and_advances_in_microseconds():
    world = sim.World(scenario())
    assert world.utime == sim.START_UTIME > 0
    world.advance_to(1 / 30)
    assert world.capture("robot1").utime == world.utime == sim.START_UTIME + 33_333
    world.advance_to(0.01)  # the past
    assert world.time_s == 1 / 30


def test_the_paper_starts_where_it_says():
    d, theta, psi = sim.World(scenario("line")).true_relative_pose("robot1")
    assert (d, math.degrees(theta), psi) == (pytest.approx(2.44, abs=1e-3), pytest.approx(-10, abs=0.01), 0.0)
    d, theta, psi = sim.World(scenario("circle")).true_relative_pose("robot1")
    assert (d, theta, psi) == (pytest.approx(1.96), 0.0, 0.0)


def test_the_leader_is_on_its_trajectory_exactly():
    # After the ramp of 0.4 s, 0.2 m/s with 0.04 m lost: at 10 s it is at 0.2 * 9.8 = 1.96 m.
    world = sim.World(scenario("line"))
    world.advance_to(10.0)
    state = world.state("leader")
    assert (state.pose.x_m, state.pose.y_m) == (pytest.approx(1.96), 0.0)
    assert state.twist.linear_mps == 0.2


def test_the_true_pose_in_the_camera_and_the_true_distance_are_the_same_truth():
    world = sim.World(scenario("circle"))
    world.command("robot1", Twist(linear_mps=0.3, angular_radps=0.2), 0.0)
    world.advance_to(0.4)
    bMc = world.scenario.robot("robot1").camera.mounting.bMc
    assert core.relative_pose(bMc @ world.true_cMo("robot1")) == pytest.approx(world.true_relative_pose("robot1"))


def prompt(robot):
    robot.drive = sim.DriveConfig(
        max_linear_acceleration_mps2=1000.0, actuator_lag_s=0.0, command_timeout_s=0.5, max_linear_mps=1.0
    )


def test_a_command_acts_from_its_time_on_and_not_before():
    world = sim.World(with_robot(scenario(), "robot1", prompt))
    start = world.state("robot1").pose.x_m
    assert world.command("robot1", Twist(linear_mps=0.5), 0.1)
    world.advance_to(0.0999)
    assert world.state("robot1").pose.x_m == start
    assert world.command_in_effect("robot1", 0.0999).linear_mps == 0.0
    assert world.command_in_effect("robot1", 0.1).linear_mps == 0.5
    world.advance_to(0.3)
    # 0.2 s at 0.5 m/s, less the ramp of 0.5 ms (1.25e-4 m).
    assert world.state("robot1").pose.x_m - start == pytest.approx(0.1, abs=2e-4)
    assert world.command_in_effect("robot1", 0.3).linear_mps == 0.5
    assert world.command_in_effect("robot1", 0.65).linear_mps == 0.0


def test_a_command_holds_until_a_newer_one_takes_effect_whatever_the_order_they_come_in():
    world = sim.World(with_robot(scenario(), "robot1", prompt))
    start = world.state("robot1").pose.x_m
    world.command("robot1", Twist(linear_mps=-0.5), 0.2)
    world.command("robot1", Twist(linear_mps=0.5), 0.1)
    world.advance_to(0.2)
    assert world.state("robot1").pose.x_m - start == pytest.approx(0.05, abs=2e-4)
    world.advance_to(0.3)
    assert world.state("robot1").pose.x_m - start == pytest.approx(0.0, abs=2e-3)


def test_a_command_that_is_not_renewed_runs_out():
    world = sim.World(with_robot(scenario(), "robot1", prompt))
    world.command("robot1", Twist(linear_mps=0.5), 0.0)
    world.advance_to(5.0)
    assert world.state("robot1").twist.linear_mps == 0.0
    # 0.5 m/s for the 0.5 s of the timeout; both ramps of 0.5 ms cancel.
    assert world.state("robot1").pose.x_m == pytest.approx(-2.4029 + 0.25, abs=1e-6)


def test_what_cannot_be_obeyed_is_refused():
    world = sim.World(scenario())
    assert not world.command("robot1", Twist(linear_mps=math.nan), 0.0)
    assert not world.command("robot1", Twist(), math.inf)
    assert not world.command("leader", Twist(linear_mps=1.0), 0.0)  # on rails
    with pytest.raises(IndexError, match="no robot 'nobody'"):
        world.state("nobody")
    with pytest.raises(IndexError, match="'leader' has no camera"):
        world.capture("leader")
    with pytest.raises(IndexError, match="'leader' follows no robot"):
        world.true_cMo("leader")


def test_frames_are_dropped_as_often_as_the_scenario_says():
    def dropping(robot):
        camera = robot.camera
        camera.model = core.CameraModel(width=32, height=32, fx=30, fy=30, cx=16, cy=16)
        camera.drop_probability = 0.2
        robot.camera = camera

    frames = pictures(sim.World(with_robot(scenario(), "robot1", dropping)), "robot1", 600)
    dropped = [frame is None for frame in frames]
    # Binomial: 120 with a standard deviation of sqrt(600 * 0.2 * 0.8) = 9.8; four of them are 39.
    assert abs(sum(dropped) - 120) < 40
    # Independent from frame to frame: two in a row 600 * 0.04 = 24 times, give or take 5 each.
    assert 8 < sum(a and b for a, b in itertools.pairwise(dropped)) < 44
    again = pictures(sim.World(with_robot(scenario(), "robot1", dropping)), "robot1", 600)
    assert [frame is None for frame in again] == dropped


def test_a_hidden_robot_is_not_in_the_picture_and_comes_back():
    def hidden(robot):
        robot.visibility = sim.Visibility(hidden_from_s=1.0, hidden_until_s=2.0)

    def before_a_plain_wall(robot):
        camera = robot.camera
        camera.imperfections = sim.Imperfections(clutter=0.0)
        robot.camera = camera

    world = sim.World(with_robot(with_robot(scenario("circle"), "leader", hidden), "robot1", before_a_plain_wall))
    bright = []
    for time_s in (0.9, 1.0, 1.9, 2.0):
        world.advance_to(time_s)
        u, v = world.scenario.robot("robot1").camera.model.project(world.true_cMo("robot1")[:3, 3] - [0, 0.25, 0])
        around = world.capture("robot1").image[int(v) - 20 : int(v) + 20, int(u) - 20 : int(u) + 20]
        bright.append(np.ptp(around) > 120)  # black and white cells
    assert bright == [True, False, False, True]


def test_a_chain_sees_its_own_leader_before_the_next():
    world = sim.World(scenario("chain"))
    assert world.true_relative_pose("robot2")[0] == pytest.approx(math.hypot(1.5, 0.2))
    assert world.true_relative_pose("robot1")[0] == pytest.approx(1.6)


def test_motion_blur_smears_what_moves_and_leaves_alone_what_stands():
    def open_shutter(robot):
        camera = robot.camera
        camera.imperfections = sim.Imperfections(
            blur_sigma_px=0.0, noise_sigma=0.0, exposure_time_s=0.02, exposure_samples=9
        )
        robot.camera = camera

    def shut(robot):
        camera = robot.camera
        camera.imperfections = sim.Imperfections(blur_sigma_px=0.0, noise_sigma=0.0)
        robot.camera = camera

    blurred, sharp = (sim.World(with_robot(scenario(), "robot1", change)) for change in (open_shutter, shut))
    # At time zero no robot moves yet; the shutter's second half sees the leader's first millimetres at most.
    still = np.abs(blurred.capture("robot1").image.astype(int) - sharp.capture("robot1").image)
    assert still.max() <= 2
    for world in (blurred, sharp):
        world.command("robot1", Twist(angular_radps=1.5), 0.0)
        world.advance_to(0.4)
    # Turning at about 1.5 rad/s for 0.02 s is 18 px: edges across the motion lose most of their steepness.
    steepness = [np.abs(np.diff(world.capture("robot1").image.astype(int), axis=1)).max() for world in (blurred, sharp)]
    assert steepness[0] < steepness[1] / 3


def test_a_recording_row_has_every_column_and_reads_back_the_same_bits():
    world = sim.World(scenario("circle"))
    world.advance_to(1 / 3)
    row = sim.recording_row(world, "robot1", command=Twist(linear_mps=1 / 7), status="tracking", delivered=False)
    fields = dict(zip(sim.recording_header().strip().split(","), row.strip().split(","), strict=True))
    assert (fields["robot"], fields["leader"], fields["status"]) == ("robot1", "leader", "tracking")
    assert fields["delivered"] == "0"
    assert float(fields["command_linear_mps"]) == 1 / 7
    assert float(fields["leader_x_m"]) == world.state("leader").pose.x_m
    assert float(fields["true_bearing_rad"]) == world.true_relative_pose("robot1")[1]


class TestAwaitedAnswers:
    def awaited(self):
        answers = sim.AwaitedAnswers(resend_after_s=0.05, give_up_after_s=1.0)
        answers.sent("robot1", 1000, 10.0)
        return answers

    def test_only_the_answer_to_the_picture_itself_counts_and_only_once(self):
        answers = self.awaited()
        assert not answers.answered("robot1", 999)
        assert not answers.answered("robot2", 1000)
        assert not answers.complete
        assert answers.answered("robot1", 1000)
        assert answers.complete
        assert not answers.answered("robot1", 1000)

    def test_it_asks_again_every_so_often(self):
        answers = self.awaited()
        assert answers.to_resend(10.04) == []
        assert answers.to_resend(10.06) == ["robot1"]
        assert answers.to_resend(10.07) == []
        assert answers.to_resend(10.12) == ["robot1"]

    def test_it_gives_up_in_the_end(self):
        answers = self.awaited()
        answers.to_resend(10.9)
        assert answers.overdue(10.9) == []
        assert answers.overdue(11.1) == ["robot1"]
