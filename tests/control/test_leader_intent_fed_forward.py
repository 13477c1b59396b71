"""Announced changes of speed that are fed forward, also upwards: what it is good for, and what a liar can do."""

import math

import numpy as np
import pytest
from leader_with_intent import LeaderWithIntent, follow, twist
from test_leader_intent import FALSE_INTENTS, SPEED_MPS, STOP_S, closest_m, same

from pilotfish import coordinator, core, data
from pilotfish.errors import ConfigError
from pilotfish.formation.chain import chain_of, drive_chain
from pilotfish.formation.relay import Announcements, Network, listening
from pilotfish.formation.stability import Trial, measure

# A word is believed for confirmed_within_s (0.15 s) before vision must have confirmed it; it acts until the next
# command after that has taken effect, one frame, one latency and one lag later (0.167 s); by feed_forward_limit_mps.
GAINED_M = 0.1 * (0.15 + 0.167)


@pytest.fixture(scope="module")
def alone():
    return follow("stop_dead")[0]


@pytest.mark.parametrize("false_intent", FALSE_INTENTS)
def test_a_false_intent_brings_a_robot_no_nearer_than_the_way_for_which_it_is_believed(false_intent, alone):
    """Also where the leader stops dead while it is believed to drive; the guard takes nothing from an intent."""
    run, _ = follow("stop_dead", LeaderWithIntent(FALSE_INTENTS[false_intent]).feed, configure=listening)
    assert closest_m(run) < closest_m(alone) + GAINED_M
    driving = (run.time_s > 6.0) & (run.time_s < STOP_S)
    assert np.abs(run.distance_error_m[driving] - alone.distance_error_m[driving]).max() < 2 * GAINED_M


@pytest.mark.parametrize("period_s", [1.0, 3.0, 8.0])
def test_a_leader_that_says_again_and_again_that_it_hurries_is_not_come_near(period_s, alone):
    word = lambda time_s, truth: twist(0.6) if time_s > 2.0 and time_s % period_s < 0.3 else truth  # noqa: E731
    run, uses = follow("stop_dead", LeaderWithIntent(word).feed, configure=listening)
    assert closest_m(run) < closest_m(alone) + GAINED_M
    assert uses["suspended"] > 100


def test_a_constant_error_of_the_announced_speed_costs_nothing_behind_a_steady_leader():
    """Odometry that is 5 % off: the difference to vision is learned, so no distance error stays. Fed forward as
    it is, 10 mm/s too much would be held by 8 mm of distance error, at a slope of 1.25/s."""
    word = LeaderWithIntent(lambda time_s, truth: twist(1.05 * truth.linear_mps, truth.angular_radps))
    run, uses = follow("line", word.feed, duration_s=20.0, configure=listening)
    late = run.time_s > 15.0
    assert uses["used"] > 400
    assert abs(run.distance_error_m[late].mean()) < 1e-4


def test_a_standing_leader_s_word_moves_nothing(alone):
    """It stopped at STOP_S; from a second later on it says that it drives."""
    word = lambda time_s, truth: twist(SPEED_MPS) if time_s > STOP_S + 1.0 else truth  # noqa: E731
    run, _ = follow("stop_dead", LeaderWithIntent(word).feed, configure=listening)
    later = run.time_s > STOP_S + 5.0
    assert np.abs(run.command_linear_mps[later]).max() < 0.005
    silent, _ = follow(
        "stop_dead",
        LeaderWithIntent(lambda time_s, truth: truth if time_s < STOP_S else None).feed,
        configure=listening,
    )
    assert np.abs(run.distance_error_m[later] - silent.distance_error_m[later]).max() < 1e-3


def test_without_a_word_it_is_the_same_to_the_bit(alone):
    run, _ = follow("stop_dead", LeaderWithIntent(lambda time_s, truth: None).feed, configure=listening)
    assert same(run, alone)


def test_a_chain_whose_robots_announce_what_they_drive_hardly_amplifies_without_a_headway():
    """One period of the camera late a robot repeats its leader's speed delta = 33 ms later, and its law corrects with a
    slope k: |G| = |s e^(-s delta) + k| / |s + k|, 1.04 at most for k = 1.25/s. Without announcements Bode's integral
    forbids it: 1.3 and more."""
    frequencies_hz = (0.1, 0.4)
    (silent,) = measure(["anticipate"], trial=Trial(robots=4, frequencies_hz=frequencies_hz), jobs=1)
    trial = Trial(robots=4, frequencies_hz=frequencies_hz, intents=Network(delay_s=0.033))
    (told,) = measure(["anticipate"], trial=trial, jobs=1)
    assert silent.peak_gain > 1.25
    assert told.peak_gain < 1.05
    assert told.step.peak_error_m.max() < 0.5 * silent.step.peak_error_m.max()


def test_a_network_that_loses_all_is_no_network_at_all():
    speed = lambda time_s: min(0.1 * time_s, 0.2)  # noqa: E731
    silent = drive_chain(chain_of(3, 1.0), "anticipate", speed, 6.0)
    lost = drive_chain(chain_of(3, 1.0), "anticipate", speed, 6.0, intents=Network(loss=1.0))
    assert np.array_equal(silent.speed_mps, lost.speed_mps)


def test_what_is_announced_arrives_after_its_delay_and_in_order():
    heard = []

    class Robot:
        def set_leader_intent(self, utime, said):
            heard.append((utime, said.linear_mps))

    line = Announcements(Network(delay_s=0.1), seed=1)
    for k in range(3):
        line.send(0.05 * k, k, core.Twist(linear_mps=0.1 * k, angular_radps=0.0))
    line.deliver(0.09, Robot())
    assert heard == []
    line.deliver(0.15, Robot())
    assert heard == [(0, 0.0), (1, 0.1)]


@pytest.mark.parametrize(("key", "value"), [("delay_s", -0.1), ("delay_s", 1.1), ("loss", 1.01), ("loss", math.nan)])
def test_a_network_that_cannot_be_is_refused_with_its_range(key, value):
    with pytest.raises(ConfigError, match=rf"{key}: .* is not allowed: 0 to 1"):
        Network(**{key: value})


def test_a_command_is_announced_for_when_it_has_taken_effect():
    """One latency and one lag after the picture: as configured, until they have been identified."""
    config = coordinator.load_coordinator(str(data.path("config/coordinator.yaml"))).coordinator
    drive = config.control.drive
    follower = coordinator.Coordinator(config)
    utime = 5_000_000
    seen = core.Observation(utime=utime, distance_m=1.5, bearing_rad=0.0, heading_rad=0.0, covariance=1e-6 * np.eye(3))
    answer = follower.step_observation(utime, seen, utime)
    expected_s = drive.latency_s + drive.actuator_lag_s
    assert answer.control.effect_utime == utime + round(1e6 * expected_s)
