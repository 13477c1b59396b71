"""The invariant of following: against runs of the model that do their worst, and where it must not be provable."""

from dataclasses import replace

import numpy as np
import pytest

from pilotfish import core, data, fuzzy, sim
from pilotfish.errors import ConfigError
from pilotfish.fuzzy_proof.enclosure import Encloser
from pilotfish.fuzzy_proof.following import least_setpoint, prove_invariant
from pilotfish.fuzzy_proof.interval import Interval
from pilotfish.fuzzy_proof.model import Following
from pilotfish.fuzzy_proof.pieces import surface_of
from pilotfish.fuzzy_proof.table import GreatestOver, bound_cells
from pilotfish.fuzzy_proof.worst_case import least_distances

MODEL = Following()


@pytest.fixture(scope="module")
def shipped():
    return fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))


@pytest.fixture(scope="module")
def grid(shipped):
    return bound_cells(Encloser(surface_of(shipped)), (200, 50))


@pytest.fixture(scope="module")
def greatest(grid):
    return GreatestOver(grid)


def test_the_greatest_over_a_box_is_that_over_the_cells_it_touches(grid, greatest):
    random = np.random.default_rng(2)
    e, ec = (np.sort(random.uniform(-1.3, 1.3, (2, 60)) * [[1.0], [1.0]], axis=0) for _ in range(2))
    found = greatest(Interval(*e), Interval(*ec))
    for k in range(60):
        cells = []
        for edges, (low, high) in ((grid.e, e[:, k]), (grid.ec, ec[:, k])):
            low, high = np.clip([low, high], edges[0], edges[-1])  # beyond the universe is its end
            cells.append(np.flatnonzero((edges[1:] >= low) & (edges[:-1] <= high)))
        assert found[k] == grid.upper[np.ix_(*cells)].max()


def test_no_output_of_the_law_is_above_the_bound_of_its_cell(shipped, grid):
    random = np.random.default_rng(3)
    x, y = random.uniform(-1, 1, (2, 20_000))
    i, j = (np.clip(np.searchsorted(edges, v) - 1, 0, len(edges) - 2) for edges, v in ((grid.e, x), (grid.ec, y)))
    u = fuzzy.infer_outputs(shipped, x, y)
    assert np.all(u <= grid.upper[i, j] + 1e-12)
    assert np.median(grid.upper[i, j] - u) < 0.03  # and the bound is worth something


def driven(controller, model, seed, duration_s=6.0):
    """The least distance of one run of the simulator's own Unicycle: a random leader, random errors, from rest."""
    random = np.random.default_rng(seed)
    unicycle = sim.Unicycle(
        sim.DriveConfig(
            max_linear_mps=model.speed_limit_mps,
            max_linear_acceleration_mps2=model.acceleration_mps2,
            actuator_lag_s=model.lag_s,
        )
    )
    gap, leader_m, leader_mps = model.stop_distance_m + random.choice([0.0, 0.01, 0.1, 0.5]), 0.0, 0.0
    errors_before, command, waiting = None, 0.0, 0.0
    least, substeps = gap, 4
    dt = model.period_s / substeps
    hold = 0
    for _ in range(int(duration_s / model.period_s)):
        distance = gap + leader_m - unicycle.state.pose.x_m
        # Errors that are all the worse for being extreme, and a leader that drives off and stops dead.
        error = model.setpoint_m - distance + random.choice([-1.0, 1.0, random.uniform(-1, 1)]) * model.noise_m
        change = 0.0 if errors_before is None else error - errors_before
        errors_before = error
        u = fuzzy.infer(controller, error / model.error_scale_m, change / model.error_change_scale_m).output
        step = model.acceleration_mps2 * model.period_s
        waiting, command = command, float(np.clip(model.velocity_scale_mps * u, command - step, command + step))
        command = float(np.clip(command, -model.reverse_limit_mps, model.speed_limit_mps))
        if hold == 0:
            leader_mps, hold = float(random.choice([0.0, 0.0, model.leader_speed_mps])), int(random.integers(1, 40))
        hold -= 1
        for _ in range(substeps):  # the latency is one period: what was commanded before acts
            unicycle.advance(core.Twist(linear_mps=waiting), dt)
            leader_m += leader_mps * dt
            least = min(least, gap + leader_m - unicycle.state.pose.x_m)
    return least


def test_where_it_is_proved_no_run_of_the_simulator_s_robot_comes_nearer(shipped, greatest):
    # As near a setpoint as can be proved with these errors: there the runs come nearest.
    setpoint_m = least_setpoint(MODEL, greatest, 1.1)
    model = replace(MODEL, setpoint_m=setpoint_m)
    assert prove_invariant(model, greatest).holds
    assert setpoint_m < 0.62  # not proved for far setpoints only
    least = min(driven(shipped, model, seed) for seed in range(12))
    assert model.stop_distance_m - 1e-9 <= least < setpoint_m


def test_a_robot_that_stops_too_slowly_is_not_proved_and_a_run_shows_why(shipped, greatest):
    # At the setpoint 0.45 m, with 0.05 m/s^2, 0.2 m/s take 0.4 m to stop: more than the 0.05 m that there are.
    model = replace(MODEL, setpoint_m=0.45, acceleration_mps2=0.05)
    assert not prove_invariant(model, greatest).holds
    least, _ = least_distances(shipped, model, *(np.array([x]) for x in (1.2, 0.0, 0.0, 0.0)), duration_s=20.0)
    assert least[0] < model.stop_distance_m


def test_a_law_that_drives_on_at_the_stop_distance_is_never_proved(greatest):
    def always_forward(e, ec):
        return np.ones(len(e.lo))

    for model in (MODEL, replace(MODEL, setpoint_m=5.0), replace(MODEL, speed_limit_mps=0.01)):
        assert not prove_invariant(model, always_forward).holds


def test_a_law_that_never_drives_forward_is_always_proved():
    def never(e, ec):
        return np.zeros(len(e.lo))

    assert prove_invariant(replace(MODEL, setpoint_m=0.4, noise_m=1.0), never).holds


def test_more_noise_never_makes_the_least_setpoint_smaller(greatest):
    least = least_setpoint(MODEL, greatest, 1.1)
    noisy = least_setpoint(replace(MODEL, noise_m=0.02), greatest, 1.1)
    assert noisy >= least + 0.01  # 15 mm more of it, less what the bisection leaves open


def test_a_number_out_of_its_range_is_refused_by_name():
    with pytest.raises(ConfigError, match=r"lag_s: 2 is outside \[0, 1\]"):
        Following(lag_s=2.0)
    with pytest.raises(ConfigError, match=r"noise_m: nan is outside"):
        Following(noise_m=float("nan"))
    with pytest.raises(ConfigError, match=r"setpoint_m: 0.3 is below stop_distance_m \(0.4\)"):
        Following(setpoint_m=0.3)
