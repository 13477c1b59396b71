"""Figures of a run, computed by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from recordings import COASTING, LOST, NO_FRAME, NO_TAG, PERIOD_US, STOP_REQUESTED, STOPPED, Writer

from pilotfish.logs import read_run
from pilotfish.logs.notes import Settings, SettingsFile
from pilotfish.logs.settings_keys import differences, keys_of
from pilotfish.logs.summary import TITLES, Summary, rms_jerk_mps3, shown, summarize
from pilotfish.logs.unseen import never_measured

PERIOD_S = PERIOD_US * 1e-6


def robot_of(writer):
    return read_run(writer.file).robots["robot1"]


def test_errors_are_of_the_frames_that_were_followed(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for distance_m in (1.0, None, 1.2, None):  # e = 100 mm and -100 mm: setpoint 1.1 m
        writer.frame(distance_m)
        writer.passes()
    summary = summarize(robot_of(writer))
    assert summary.rms_distance_error_mm == pytest.approx(100.0)
    assert summary.p95_distance_error_mm == pytest.approx(100.0)
    assert summary.measured_share == summary.followed_share == 0.5
    assert summary.frames == 4
    assert summary.duration_s == pytest.approx(3 * PERIOD_S)
    assert summary.frame_rate_hz == pytest.approx(1 / PERIOD_S)
    assert summary.latency_max_ms == pytest.approx(2.0)  # recordings.py
    assert summary.missed_deadlines == 0


def test_settling_counts_from_the_last_setpoint(tmp_path):
    """Behind a new setpoint the distance falls by 10 mm a frame, from 600 mm too far to none, and rests there: from the
    55th period on it is within 50 mm."""
    writer = Writer(tmp_path / "run.log")
    for _ in range(40):
        writer.frame(2.0)
        writer.passes()
    for k in range(600):
        writer.frame(1.3 + max(0, 60 - k) * 0.01, setpoint_m=1.3)
        writer.passes()
    summary = summarize(robot_of(writer))
    assert summary.settling_s == pytest.approx(55 * PERIOD_S, abs=1.1 * PERIOD_S)
    assert summary.steady_distance_error_mm == pytest.approx(0.0, abs=1e-9)


def approach(writer, setpoint_m=1.1):
    """From 0.5 m too far, 10 mm nearer a frame, then 350 frames that are 2 mm too far: the last quarter of 400 frames
    is behind the approach."""
    for k in range(400):
        writer.frame(setpoint_m + 0.002 + max(0, 50 - k) * 0.01, setpoint_m=setpoint_m)
        writer.passes()


def test_errors_after_the_approach_do_not_have_the_way_from_the_start_in_them(tmp_path):
    """Behind it the error is 2 mm throughout. With it: 350 of 2 mm, and 12, 22, ... 502 mm."""
    writer = Writer(tmp_path / "run.log")
    approach(writer)
    summary = summarize(robot_of(writer))
    assert summary.rms_distance_error_mm == pytest.approx(2.0, abs=1e-6)
    assert summary.p95_distance_error_mm == pytest.approx(2.0, abs=1e-6)
    whole_mm = math.sqrt((350 * 2.0**2 + sum((2.0 + 10.0 * k) ** 2 for k in range(1, 51))) / 400)
    assert summary.rms_whole_distance_error_mm == pytest.approx(whole_mm, rel=1e-6)
    assert summary.approach_from_mm == pytest.approx(-502.0)
    assert summary.settling_s == pytest.approx(45 * PERIOD_S, abs=1.1 * PERIOD_S)


def test_an_earlier_setpoint_is_not_in_the_errors_after_the_approach(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for _ in range(300):
        writer.frame(1.5)
        writer.passes()
    approach(writer, setpoint_m=1.3)
    assert summarize(robot_of(writer)).rms_distance_error_mm == pytest.approx(2.0, abs=1e-6)


def test_the_figures_after_the_approach_are_those_of_an_experiment(tmp_path):
    """The same samples as the experiments' own metrics see them."""
    from pilotfish.metrics import settling_time_s, steady_state_error_m, steady_window

    writer = Writer(tmp_path / "run.log")
    chance = np.random.default_rng(3)
    distances_m = 1.1 + 0.4 * np.exp(-np.arange(300) / 20) + 0.01 * chance.normal(size=300)
    for distance_m in distances_m:
        writer.frame(float(distance_m))
        writer.passes()
    time_s, error_m = np.arange(300) * PERIOD_S, 1.1 - distances_m
    steady = steady_window(time_s)
    summary = summarize(robot_of(writer))
    assert summary.rms_distance_error_mm == pytest.approx(1e3 * np.sqrt(np.mean(error_m[steady] ** 2)))
    assert summary.steady_distance_error_mm == pytest.approx(1e3 * steady_state_error_m(time_s, error_m))
    assert summary.settling_s == pytest.approx(settling_time_s(time_s, error_m))


def test_jerk_is_the_second_difference_and_gaps_count_nothing():
    """v = a t^2 has the second difference 2 a T^2, so jerk 2 a, wherever it is; the jump over the gap is no jerk."""
    time_s = np.concatenate([np.arange(50) * 0.1, 100.0 + np.arange(50) * 0.1])
    speed_mps = 0.3 * np.concatenate([np.arange(50) * 0.1, np.arange(50) * 0.1]) ** 2
    assert rms_jerk_mps3(time_s, speed_mps) == pytest.approx(0.6, rel=1e-6)


def test_a_run_of_one_frame_without_a_leader_has_figures_all_the_same(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame(None)
    summary = summarize(robot_of(writer))
    assert math.isnan(summary.rms_distance_error_mm) and math.isnan(summary.settling_s)
    assert all(shown(name, getattr(summary, name)) for name in TITLES)


def test_zeros_for_want_of_a_picture_are_counted_each_stretch_once(tmp_path):
    """Before the first picture nothing was followed; then 3 zeros in one gap, and 1 in another, 0.2 s and 0.1 s long. A
    gap that was only coasted through, and a stop, are none."""
    writer = Writer(tmp_path / "run.log")
    writer.command(LOST, NO_FRAME, linear_mps=0.0)
    for k in range(40):
        writer.frame()
        zeros = {10: 3, 20: 1}.get(k, 0)
        if zeros or k == 30:
            writer.command(COASTING, NO_FRAME)
        for _ in range(zeros):
            writer.wall_us += 50_000
            writer.command(LOST, NO_FRAME, linear_mps=0.0)
        writer.passes()
    writer.command(STOPPED, STOP_REQUESTED, linear_mps=0.0)
    summary = summarize(robot_of(writer))
    assert summary.zeros_without_picture == 2
    assert summary.followed_share == 1.0  # of the frames: these say nothing of it
    assert shown("zeros_without_picture", summary.zeros_without_picture) == "2"


def test_every_figure_has_a_title():
    assert set(TITLES) == set(Summary.__dataclass_fields__)


def settings(text, program="p 1", overrides=(), role="config"):
    return Settings(program, "", overrides, (SettingsFile(role, "x.yaml", text),))


def test_settings_differ_key_by_key_and_not_by_layout():
    one = settings("a: {b: 1, c: [1, 2]}\nd: x\n")
    other = settings("# other words, other order\nd: x\na:\n  c: [1, 2]\n  b: 2\n")
    assert differences({"one": one, "other": other}) == {"config: a.b": ["1", "2"]}


def test_a_key_that_only_one_run_has_and_another_program_are_differences():
    one, other = settings("a: 1", overrides=("law=fuzzy",)), settings("a: 1\nb: {c: 2}", program="p 2")
    assert differences({"one": one, "other": other}) == {
        "program": ["p 1", "p 2"],
        "command line: law": ["fuzzy", None],
        "config: b.c": [None, "2"],
    }


def test_lists_of_tables_are_compared_by_their_place():
    assert keys_of(settings("tags: [{id: 0}, {id: 4, at: [1, 2]}]")) == {
        "config: tags.0.id": "0",
        "config: tags.1.id": "4",
        "config: tags.1.at": "[1, 2]",
    }


@pytest.mark.parametrize(
    "text",
    [
        "a: [",
        "\x00",
        "[" * 3000,
        "a: &a [x, x]\n"
        + "".join(f"k{n}: &k{n} [*{p}, *{p}, *{p}]\n" for n, p in enumerate(["a", *[f"k{k}" for k in range(40)]])),
        "a: &a\n  b: *a\n",
    ],
)
def test_texts_that_are_no_settings_do_no_harm(text):
    assert len(keys_of(settings(text))) <= 20_001


def test_a_run_without_a_measurement_names_the_cause_of_its_statuses(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for k in range(10):
        writer.frame(None, reason=NO_TAG if k else 22)
        writer.passes()
    assert never_measured(robot_of(writer)) == (
        "the leader was never measured: no tag in the picture (9 of 10 frames); "
        "the camera shows the same pixels again and again (1 of 10 frames)"
    )
    writer.frame(1.0)
    assert never_measured(robot_of(writer)) == ""
