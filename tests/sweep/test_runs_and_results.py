"""A run's row is what the harness gives for the same settings and seeds, wherever it is made; a folder of results goes
on where it ended; what fails is a row."""

import fcntl
import math

import numpy as np
import pytest

from pilotfish import data, sim
from pilotfish.errors import CampaignError, ConfigError, MissingFileError
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.scenario import Scenario
from pilotfish.metrics import evaluate
from pilotfish.sweep.play import play_all, seeds
from pilotfish.sweep.run import run_campaign
from pilotfish.sweep.store import LOCK
from sweep.campaigns import SPEED, loaded, rows, written


@pytest.mark.parametrize("law", ["paper", "pid"])
def test_a_row_is_the_harness_s_run_with_the_same_settings_and_seeds(tmp_path, law):
    """Bit for bit. The view is given, because the harness's is a round number and a campaign's is the calibration's."""
    changes = {"set": {"measurements.half_view_deg": 26.0}, "factors": {"law": [law], SPEED: [0.3]}, "metrics": None}
    campaign = loaded(tmp_path, **changes)
    (row,) = play_all(campaign.job, [campaign.run(1)]).rows
    scenario = Scenario.load(data.path("scenarios/line.yaml"))
    spec = sim.load_scenario(scenario.file)
    spec.seed, spec.robots = row["world_seed"], [_faster(robot) for robot in spec.robots]
    drawn = DrawnObservations(row["noise_seed"])
    run = run_in_process(scenario, profile=law, spec=spec, drawn=drawn, duration_s=1.0).recordings["robot1"]
    figures = evaluate(run)
    assert row["rms_distance_mm"] == 1e3 * figures.rms_error_m
    assert row["rms_jerk_mps3"] == figures.rms_jerk_mps3
    assert row["min_distance_m"] == run.true_distance_m.min()
    assert (row["outcome"], row["settling_s"]) == ("ok", None)  # 1 s is shorter than a settled stretch must be


def _faster(robot):
    if robot.name == "leader":
        trajectory = robot.trajectory
        trajectory.profile.speed_mps = 0.3
        robot.trajectory = trajectory
    return robot


def test_the_calibration_s_view_and_focal_length_are_those_of_the_drawn_measurements(tmp_path):
    """The shipped calibration: 640 px wide, cx = 321.3, f = 600: its nearer edge lies 318.2 px right of the centre, so
    without distortion atan(318.2 / 600) = 27.9 deg. Less 2 deg for half a tag; the lens's k1 = -0.08 adds some tenths.
    With twice the focal length every sigma is half."""
    from pilotfish.sweep.play import drawn

    robot = sim.load_scenario(data.path("scenarios/line.yaml")).robot("robot1")
    usual = drawn(robot, {}, 1)
    assert math.degrees(usual.half_view_rad) == pytest.approx(26.3, abs=0.5)
    camera = robot.camera
    model = camera.model
    twice = {name: getattr(model, name) for name in ("width", "height", "cx", "cy")}
    camera.model = type(model)(fx=1200.0, fy=1200.0, **twice)
    robot.camera = camera
    near = drawn(robot, {}, 1)
    assert near.noise.bearing_sigma_rad == pytest.approx(usual.noise.bearing_sigma_rad / 2)
    assert near.half_view_rad == pytest.approx(math.atan(318.2 / 1200) - math.radians(2.0), abs=1e-3)


def test_a_run_s_noise_depends_on_its_own_values_and_repetition_and_not_on_other_points(tmp_path):
    small = loaded(tmp_path, factors={"law": ["pid"], SPEED: [0.2]})
    large = loaded(tmp_path, factors={"law": ["paper", "pid"], SPEED: [0.1, 0.2, 0.3]}, runs=5)
    same = next(large.run(k) for k in range(large.count) if large.run(k).factors == small.run(0).factors)
    assert seeds(small.job, small.run(0)) == seeds(large.job, same)
    every = {seeds(large.job, large.run(k)) for k in range(large.count)}
    assert len(every) == large.count
    other = loaded(tmp_path, factors={"law": ["pid"], SPEED: [0.2]}, seed=2)
    assert seeds(other.job, other.run(0)) != seeds(small.job, small.run(0))


def test_common_seeds_give_run_k_of_every_point_the_same_noise(tmp_path):
    campaign = loaded(tmp_path, seeds="common", runs=3)
    found = {}
    for k in range(campaign.count):
        spec = campaign.run(k)
        found.setdefault(spec.repetition, set()).add(seeds(campaign.job, spec))
    assert [len(each) for each in found.values()] == [1, 1, 1]
    assert len(set.union(*found.values())) == 3


def test_a_campaign_goes_on_where_it_was_stopped_and_every_run_is_done_once(tmp_path):
    campaign, calls = loaded(tmp_path), iter([False, False, False, True])
    first = run_campaign(campaign, tmp_path / "out", stopping=lambda: next(calls))
    assert (first.done, first.total) == (3, 8)
    second = run_campaign(campaign, tmp_path / "out")
    assert (second.before, sum(second.outcomes.values())) == (3, 5)
    assert run_campaign(campaign, tmp_path / "out").outcomes == {}
    whole = rows(tmp_path / "out")
    assert [row["run"] for row in whole] == list(range(8))
    run_campaign(campaign, tmp_path / "at once")
    assert rows(tmp_path / "at once") == whole


def test_a_changed_campaign_is_refused_with_what_differs(tmp_path):
    run_campaign(loaded(tmp_path, runs=1, factors={"law": ["paper"]}), tmp_path / "out")
    changed = loaded(tmp_path, runs=1, factors={"law": ["paper"]}, set={"robots.robot1.drive.slip": 0.01})
    with pytest.raises(ConfigError, match=r"another campaign; what differs:\n  set.*slip: nothing -> 0\.01"):
        run_campaign(changed, tmp_path / "out")
    with pytest.raises(ConfigError, match=r"scenario: .*line.* -> .*circle"):
        run_campaign(loaded(tmp_path, scenario="circle", runs=1, factors={"law": ["paper"]}), tmp_path / "out")


def test_a_folder_of_something_else_is_left_alone(tmp_path):
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "cat.png").touch()
    with pytest.raises(ConfigError, match="not empty, and no folder of a campaign"):
        run_campaign(loaded(tmp_path), tmp_path / "photos")
    assert [file.name for file in (tmp_path / "photos").iterdir()] == ["cat.png"]
    with pytest.raises(MissingFileError, match="no folder of a campaign"):
        rows(tmp_path / "photos")


def test_two_commands_do_not_write_into_one_folder(tmp_path):
    campaign = loaded(tmp_path, runs=1, factors={"law": ["paper"]})
    run_campaign(campaign, tmp_path / "out")
    with (tmp_path / "out" / LOCK).open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(CampaignError, match="another `pilotfish sweep` writes there"):
            run_campaign(campaign, tmp_path / "out")


FAILING = {
    # 1.1 m are asked for; at the start the robots are 2.44 m apart, which is nearer than the 3 m called a collision.
    "collision": ({"collision_distance_m": 3.0}, "collision", "2.440 m apart after 0.00 s"),
    # The leader hides at 0.4 s: the last frame before is that at 11/30 s, the last of all at 29/30 s.
    "leader lost": ({"set": {"robots.leader.body.hidden_from_s": 0.39}, "lost_after_s": 0.5}, "leader_lost", "0.37 s"),
    "never seen": ({"set": {"measurements.half_view_deg": 1.0}, "lost_after_s": 0.5}, "leader_lost", "never measured"),
    # Each value is allowed, both together are not.
    "not simulated": (
        {
            "factors": {
                "robots.robot1.camera.latency_s": [0.033, 0.01],
                "robots.robot1.camera.latency_jitter_s": [0.0, 0.02],
            }
        },
        "error",
        "latency_jitter_s: 0.020000 is more than latency_s",
    ),
}


@pytest.mark.parametrize(("changes", "outcome", "reason"), FAILING.values(), ids=FAILING)
def test_a_run_that_fails_is_a_row_with_its_reason(tmp_path, changes, outcome, reason):
    campaign = loaded(tmp_path, **({"runs": 1, "factors": {"law": ["paper"]}} | changes))
    summary = run_campaign(campaign, tmp_path / "out")
    assert summary.done == summary.total
    last = rows(tmp_path / "out")[-1]
    assert last["outcome"] == outcome
    assert reason in last["reason"] and "/" not in last["reason"].replace("m/s", "")
    assert (last["rms_distance_mm"] is None) == (outcome == "error")


def test_an_exception_of_ours_is_a_row_too(tmp_path, monkeypatch):
    def broken(*_):
        raise ZeroDivisionError("a bug")

    campaign = loaded(tmp_path, runs=1)
    monkeypatch.setattr("pilotfish.sweep.play.record", broken)
    assert run_campaign(campaign, tmp_path / "out").outcomes == {"error": 4}
    assert {row["reason"] for row in rows(tmp_path / "out")} == {"ZeroDivisionError: a bug"}


def test_dropped_pictures_are_as_many_as_their_probability_says(tmp_path):
    """Of 600 pictures 30 % are dropped: 420 remain, with a standard deviation of sqrt(600 0.3 0.7) = 11; four of them.
    Tracked are all that are delivered."""
    from pilotfish.sweep.play import record

    dropping = {"robots.robot1.camera.drop_probability": 0.3}
    campaign = loaded(tmp_path, duration_s=20.0, set=dropping, factors={"law": ["paper"]})
    campaign.documents.write_files(tmp_path)
    run = record(campaign.job, campaign.run(0), tmp_path)
    assert abs(int(run.delivered.sum()) - 420) <= 45
    assert (run.status[run.delivered] == "tracking").all()
    assert np.isnan(run.measured_distance_m[~run.delivered]).all()


def test_values_of_every_kind_come_back_from_the_results(tmp_path):
    factors = {
        "robots.robot1.drive.slip": [0, 0.01],
        "who": {"levels": {"slow": {"law": "paper", SPEED: 0.1}, "fast": {"law": "pid", SPEED: 0.3}}},
        "scenario.hardware": [None, "hardware/nonideal.yaml"],
    }
    from pilotfish.sweep.results import load_results

    campaign = loaded(tmp_path, runs=1, factors=factors)
    run_campaign(campaign, tmp_path / "out")
    results = load_results(tmp_path / "out")
    assert results.factor("slip")[1].tolist() == [0.0] * 4 + [0.01] * 4
    assert results.factor("who.speed_mps")[1].tolist() == [0.1, 0.1, 0.3, 0.3] * 2
    assert results.factor("hardware")[1].tolist()[:2] == ["none", "hardware/nonideal.yaml"]
    assert len(results.where(["who=fast", "slip=0.01"])) == 2
    for wrong, said in (("who", "FACTOR=VALUE"), ("who=medium", "who is slow, fast"), ("slip=x", "not a number")):
        with pytest.raises(ConfigError, match=said):
            results.where([wrong])


def test_the_file_may_be_written_otherwise_as_long_as_it_says_the_same(tmp_path):
    file = written(tmp_path, runs=1)
    run_campaign(loaded(tmp_path, runs=1), tmp_path / "out")
    file.write_text("# a comment\n" + file.read_text())
    from pilotfish.sweep.campaign import load_campaign

    assert run_campaign(load_campaign(file), tmp_path / "out").outcomes == {}
