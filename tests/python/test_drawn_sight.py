"""Measurements that are drawn instead of rendered."""

import numpy as np
import pytest

from pilotfish import data as shipped
from pilotfish import sim
from pilotfish.harness.drawn_observations import DrawnObservations, ObservationNoise


def world_of(which):
    return sim.World(sim.load_scenario(shipped.path(f"scenarios/{which}.yaml")))


def test_a_thousand_measurements_scatter_as_their_covariance_says():
    """The sample variance of n normal numbers is off by sqrt(2/n) of itself, 4.5 % here; four of those are allowed."""
    world, drawn = world_of("line"), DrawnObservations(seed=1)
    truth = np.array(world.true_relative_pose("robot1"))
    seen = [drawn.look(world, "robot1") for _ in range(1000)]
    errors = np.array([[s.distance_m, s.bearing_rad, s.heading_rad] for s in seen]) - truth
    claimed = np.sqrt(np.diag(ObservationNoise().covariance(truth[0])))
    assert np.abs(errors.mean(0) / claimed).max() < 4 / np.sqrt(1000)
    assert errors.std(0) == pytest.approx(claimed, rel=0.09)


def test_a_hidden_leader_is_not_measured():
    world, drawn = world_of("occlusion"), DrawnObservations(seed=1)
    for time_s, is_seen in ((14.9, True), (15.5, False), (16.1, True)):
        world.advance_to(time_s)
        distance_m, bearing_rad, _ = world.true_relative_pose("robot1")
        drawn = DrawnObservations(seed=1, half_view_rad=np.pi)  # robot1 is not driven here: only hiding counts
        assert (drawn.look(world, "robot1") is not None) == is_seen, (time_s, distance_m, bearing_rad)


def test_outside_the_view_nothing_is_measured():
    assert DrawnObservations(seed=1, half_view_rad=np.radians(9.0)).look(world_of("line"), "robot1") is None
