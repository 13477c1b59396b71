"""Recordings: what is written can be read, what is broken is refused with its name."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic_run import exponential_run

from pilotfish.errors import RecordingError
from pilotfish.recording import COLUMNS, Recording, read_csv, wrap_angle

SIM_COLUMNS = (
    "time_s,utime_us,robot,leader,x_m,y_m,heading_rad,linear_mps,angular_radps,leader_x_m,leader_y_m,"
    "leader_heading_rad,leader_linear_mps,true_distance_m,true_bearing_rad,true_heading_rad,"
    "command_linear_mps,command_angular_radps,status,delivered"
)


def sim_row(robot: str, time_s: float) -> str:
    utime_us = round(1e6 * time_s)
    return f"{time_s},{utime_us},{robot},leader,0,0,0,0.1,0,2,0,0,0.2,2,0,0,0.1,0,tracking,1"


def test_a_recording_comes_back_bit_for_bit(tmp_path):
    run = exponential_run()
    run = replace(run, true_distance_m=run.true_distance_m / 3.0)  # no short decimal form
    run.measured_distance_m[5] = np.nan
    back = Recording.from_csv(run.to_csv(tmp_path / "deep" / "run.csv"))
    assert back.meta == run.meta
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(back, name), getattr(run, name), err_msg=name)


def test_a_file_of_the_simulator_gives_one_recording_a_robot(tmp_path):
    file = tmp_path / "sim.csv"
    rows = [sim_row(robot, time_s) for time_s in (0.0, 0.1, 0.2) for robot in ("robot1", "robot2")]
    file.write_text("\n".join([SIM_COLUMNS, *rows]) + "\n")
    runs = read_csv(file)
    assert list(runs) == ["robot1", "robot2"]
    assert len(runs["robot1"]) == len(runs["robot2"]) == 3
    np.testing.assert_array_equal(runs["robot2"].utime_us, [0, 100000, 200000])
    assert np.isnan(runs["robot1"].measured_distance_m).all()
    assert np.isnan(runs["robot1"].meta.distance_setpoint_m)


def test_with_several_robots_in_a_file_one_must_be_named(tmp_path):
    file = tmp_path / "sim.csv"
    file.write_text("\n".join([SIM_COLUMNS, sim_row("robot1", 0.0), sim_row("robot2", 0.0)]))
    with pytest.raises(RecordingError, match="name the robot; in the file: robot1, robot2"):
        Recording.from_csv(file)
    assert Recording.from_csv(file, "robot2").meta.robot == "robot2"
    with pytest.raises(RecordingError, match="no robot 'robot3'"):
        Recording.from_csv(file, "robot3")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "no columns 'robot' and 'leader'"),
        ("a,b\n1,2\n", "no columns 'robot' and 'leader'"),
        (SIM_COLUMNS + "\n", "no rows"),
        (SIM_COLUMNS.replace(",x_m", ",xx_m") + "\n" + sim_row("robot1", 0.0), "x_m"),
        (SIM_COLUMNS + "\n" + sim_row("robot1", 0.0).replace("0.2", "fast"), "fast"),
        (
            SIM_COLUMNS + "\n" + sim_row("robot1", 0.1) + "\n" + sim_row("robot1", 0.1),
            "time_s does not increase",
        ),
        (SIM_COLUMNS + "\n" + sim_row("robot1", 0.1)[:30], "missing column or value"),
        (
            "# distance_setpoint_m: far\n" + SIM_COLUMNS + "\n" + sim_row("robot1", 0.0),
            "setpoint is not a number",
        ),
    ],
)
def test_a_broken_file_is_refused_with_its_name_and_what_is_wrong(tmp_path, text, complaint):
    file = tmp_path / "broken.csv"
    file.write_text(text)
    with pytest.raises(RecordingError, match=complaint) as caught:
        Recording.from_csv(file)
    assert "broken.csv" in str(caught.value)


def test_columns_of_different_lengths_are_refused():
    run = exponential_run()
    with pytest.raises(RecordingError, match="different lengths"):
        replace(run, x_m=run.x_m[:-1])


def test_measurements_join_by_the_time_of_the_exposure():
    run = exponential_run(seconds=0.1)  # 0, 33333, 66667, 100000 us
    run = run.with_measurements({33333: (2.0, 0.1, 0.2), 5: (9.0, 9.0, 9.0)})
    np.testing.assert_array_equal(run.measured_distance_m, [np.nan, 2.0, np.nan, np.nan])
    np.testing.assert_array_equal(run.measured_heading_rad, [np.nan, 0.2, np.nan, np.nan])


def test_angles_wrap_into_the_half_open_interval_up_to_pi():
    angles = np.array([0.0, np.pi, -np.pi, 3 * np.pi, np.pi + 0.5, -np.pi - 0.5, 100.0])
    expected = np.array([0.0, np.pi, np.pi, np.pi, -np.pi + 0.5, np.pi - 0.5, 100.0 - 32 * np.pi])
    np.testing.assert_allclose(wrap_angle(angles), expected, atol=1e-12)
