"""What bench/sim makes of the lines of its program, and the scenarios it plays."""

import pytest

from bench.sim.figures import crowd_figures, exponent, loop_figures, ratios
from bench.sim.scenarios import CONDITIONS, column, following
from pilotfish import sim
from pilotfish.harness.scenario import Scenario


def line(loop, frame, ms, error_mm=0.0):
    return {
        "loop": loop,
        "row": ["Pilotfish", "other"].index(loop),
        "frame": frame,
        "move_ns": 0,
        "render_ns": 0.75e6 * ms,
        "see_decide_ns": 0.25e6 * ms,
        "seen": True,
        "distance_error_m": 1e-3 * error_mm,
        "bearing_error_rad": 0.0,
    }


def test_frames_per_second_count_every_frame_and_errors_those_after_settling():
    """Ours: 1 + 1 + 1 + 5 ms for 4 frames, 500 a second. The other: 20 ms each, 50 a second, ten times fewer. Errors of
    the last two of four frames: 3 and 4 mm, RMS 5 / sqrt(2)."""
    ours = [line("Pilotfish", k, ms, mm) for k, (ms, mm) in enumerate([(1, 900), (1, 900), (1, 3), (5, 4)])]
    rows = loop_figures([line("other", k, 20) for k in range(4)] + ours[::-1])
    assert [row.loop for row in rows] == ["Pilotfish", "other"]
    assert rows[0].frames_per_s == pytest.approx(500.0)
    assert rows[0].frame_ms == pytest.approx(1.0)
    assert rows[0].render_ms == pytest.approx(0.75)
    assert rows[0].distance_rms_mm == pytest.approx(5 / 2**0.5)
    assert ratios(rows) == {"Pilotfish": pytest.approx(1.0), "other": pytest.approx(10.0)}


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0])
def test_the_exponent_is_that_of_a_power_law(power):
    robots = [1, 2, 5, 20, 100]
    assert exponent(robots, [3.0 * count**power for count in robots]) == pytest.approx(power)


def test_the_processor_time_of_a_crowd_is_shared_by_its_threads():
    """4 robots, 10 frames of 50 ms in 0.1 s of work on 2 threads: 0.05 s each, ten times real time; by the clock it
    took 0.25 s, twice."""
    said = {
        "robots": 4,
        "frames": 10,
        "threads": 2,
        "simulated_s": 0.5,
        "elapsed_s": 0.25,
        "frame_ns": [20e6] * 9 + [70e6],
        "capture_ns": 80e6,
        "step_ns": 20e6,
        "move_ns": 0,
        "made_s": 0.1,
        "seen": 1.0,
        "worst_rms_distance_error_m": 0.002,
        "pictures": "1",
    }
    row = crowd_figures(said)
    assert (row.real_time_factor, row.on_free_processors) == pytest.approx((2.0, 10.0))
    assert (row.render_ms, row.answer_ms, row.robot_frame_ms) == pytest.approx((2.0, 0.5, 2.5))
    assert (row.frame_p50_ms, row.frame_p99_ms) == pytest.approx((20.0, 70.0))


def test_a_column_is_a_scenario_in_which_each_follows_the_one_before_with_tags_of_its_own(tmp_path):
    scenario = Scenario.load(column(3, tmp_path))
    assert [(robot.name, robot.leader) for robot in scenario.robots] == [
        ("robot1", "leader"),
        ("robot2", "robot1"),
        ("robot3", "robot2"),
    ]
    worn = [tag.id for robot in sim.load_scenario(scenario.file).robots for tag in robot.body.leader.tags]
    assert sorted(set(worn)) == list(range(12))


@pytest.mark.parametrize("condition", CONDITIONS)
def test_each_condition_is_the_camera_it_says(condition, tmp_path):
    file = following(condition, tmp_path)
    (robot,) = Scenario.load(file).robots
    camera = sim.load_scenario(file).robot(robot.name).camera
    assert (camera.model.k1 == 0.0) == (condition == "ideal")
    assert (camera.imperfections.noise_sigma == 0.0) == (condition == "ideal")
    assert (camera.imperfections.gamma != 1.0) == (condition == "non-ideal")
