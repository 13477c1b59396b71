"""Pictures that do not come: dropped, slow, hidden for a moment. The command is zero as soon as the last measurement is
too old, as the rule demands; what is known of the leader and of the wheels is not forgotten with it."""

import numpy as np
import pytest

from pilotfish import control, core, data, fuzzy
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.timed import Timing, run_timed

SEEDS = (1, 2, 3)


@pytest.mark.parametrize(("rate_hz", "drops"), [(30.0, 0.2), (30.0, 0.5), (20.0, 0.2)])
def test_dropped_pictures_cost_little_distance(rate_hz, drops):
    # Of pictures at 30 Hz with half of them dropped, a sixteenth of the gaps lasts 133 ms, a thirty-second 167 ms, ...:
    # the command is zero for 33 ms more each. Slowing down at a = 1 m/s^2 and catching up loses a t^2: 1, 4, 10, 18 mm,
    # in sum some 8 mm a second, which the law takes back within half a second. Before the estimate went on over a gap:
    # +4 mm at 20 %, +133 mm at 50 % of 30 Hz, +6 mm at 20 Hz.
    timing = Timing(frame_rate_hz=rate_hz, drop_probability=drops)
    errors_m = [run_timed("line", timing=timing, seed=k, duration_s=30.0).distance_error_m(10.0) for k in SEEDS]
    assert abs(np.mean(errors_m)) < (0.010 if drops > 0.2 else 0.002)


@pytest.mark.parametrize("rate_hz", [9.0, 9.9, 12.0])
def test_a_slow_camera_is_followed_at_its_speed(rate_hz):
    # At 9 Hz the command is zero for 11 ms of each 111 ms. Before: 3 m behind for ever, at 0.11 m/s.
    timing = Timing(frame_rate_hz=rate_hz)
    assert np.abs(run_timed("line", timing=timing, duration_s=20.0).distance_error_m(10.0)).max() < 0.010


@pytest.mark.parametrize("scenario", ["line", "circle"])
def test_eight_pictures_a_second_are_enough_with_a_bounded_blind_way(scenario):
    def slow_camera(config):
        safety, control_ = config.safety, config.control
        limits = control_.limits
        safety.max_age_s, limits.max_linear_mps, limits.max_reverse_mps = 0.2, 0.3, 0.3  # 60 mm of blind travel
        config.safety = safety
        control_.limits = limits
        config.control = control_

    run = run_timed(scenario, timing=Timing(frame_rate_hz=8.0), duration_s=30.0, configure=slow_camera)
    assert np.abs(run.distance_error_m(20.0)).max() < 0.010


class HiddenFor(DrawnObservations):
    """A leader that something hides at 15 s, when the robot follows it at 0.2 m/s."""

    hidden_s = 0.0

    def look(self, world, robot):
        return None if 15.0 <= world.time_s < 15.0 + self.hidden_s else super().look(world, robot)


def first_answer_after(hidden_s):
    drawn, answers = HiddenFor(seed=1), []
    drawn.hidden_s = hidden_s
    run_timed("line", drawn=drawn, duration_s=18.0, on_answer=lambda time_s, answer: answers.append((time_s, answer)))
    return next(a for t, a in answers if t > 15.0 + hidden_s and a.status == core.Status.tracking)


def test_after_a_gap_the_command_starts_from_the_speed_that_is_left():
    # The command is zero from 100 ms after the last measurement until the next comes at 200 ms and acts: the set value
    # falls by 1 m/s^2 * 0.1 s from 0.2 m/s, and may rise by 1 m/s^2 / 30 Hz again.
    answer = first_answer_after(hidden_s=0.17)
    assert answer.command.linear_mps == pytest.approx(0.2 - 0.1 + 1.0 / 30.0, abs=0.01)
    assert answer.control.feed_forward_weight > 0.9


def test_after_a_long_gap_the_leader_is_a_new_one_and_the_robot_starts_from_rest():
    answer = first_answer_after(hidden_s=1.2)
    assert 0.0 < answer.command.linear_mps <= 1.0 / 30.0 + 1e-9
    assert answer.control.feed_forward_weight < 0.2


def test_a_pause_before_the_first_measurement_changes_nothing():
    law = fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))
    config, wanted = control.FollowerConfig(law=law), core.Setpoint(distance_m=1.0, bearing_rad=0.0)
    paused, other = control.Follower(config), control.Follower(config)
    paused.pause(100_000)
    for k in range(5):
        seen = core.Observation(utime=k * 33_333, distance_m=1.3, covariance=np.diag([1e-8] * 3))
        assert paused.follow(seen, wanted).command == other.follow(seen, wanted).command
