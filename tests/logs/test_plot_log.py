"""Pictures of recorded runs."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image
from recordings import COASTING, LOST, NO_FRAME, Writer

from pilotfish.logs import read_run
from pilotfish.plots.relative_view import draw_relative_view
from pilotfish.plots.run_overview import draw_run_overview
from pilotfish.plots.status_band import band_pieces, draw_status_band, silences, status_stretches
from pilotfish.plots.style import DARK, save


def curve(axes, number=1):
    """(t, values) of a line; line 0 is the zero line."""
    line = axes.get_lines()[number]
    return np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)


def test_the_curves_are_the_errors_in_millimetres_and_degrees(recorded):
    robot = read_run(recorded.box).robots["robot1"]
    figure = draw_run_overview({"robot1": robot})
    _, distance, _magnified, bearing, speed, turn, latency = figure.axes
    frames, commands = robot.frames, robot.commands
    for axes, table, expected in (
        (distance, frames, 1e3 * frames["error_m"]),
        (bearing, frames, np.degrees(frames["bearing_rad"] - frames["setpoint_bearing_rad"])),
        (speed, commands, commands["linear_mps"]),
        (turn, commands, np.degrees(commands["angular_radps"])),
        (latency, frames, 1e3 * frames["latency_s"]),
    ):
        time_s, values = curve(axes)
        assert axes.get_yscale() == "linear"
        np.testing.assert_allclose(values[np.isfinite(values)], expected, rtol=0, atol=1e-9)
        np.testing.assert_allclose(time_s[np.isfinite(time_s)], table["t_s"])


def test_a_zero_between_two_frames_is_seen_in_the_commanded_speed(tmp_path):
    """Every frame is followed at 0.1 m/s; once no picture came, and the robot was told to stand still meanwhile."""
    writer = Writer(tmp_path / "run.log")
    for k in range(60):
        writer.frame()
        if k == 30:
            writer.wall_us += 20_000
            writer.command(LOST, NO_FRAME, linear_mps=0.0)
        writer.passes()
    robot = read_run(writer.file).robots["robot1"]
    assert robot.frames["command_linear_mps"].min() == 0.1
    _, speed_mps = curve(draw_run_overview({"robot1": robot}).axes[4])
    assert speed_mps.min() == 0.0 and np.median(speed_mps) == 0.1


def test_the_band_shows_what_was_sent_also_while_no_frame_came(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for _ in range(10):
        writer.frame()
        writer.passes()
    for k in range(20):
        writer.command(COASTING if k < 3 else LOST, NO_FRAME)
        writer.wall_us += 50_000
    stretches = status_stretches(read_run(writer.file).robots["robot1"])
    assert [status for _, _, status in stretches] == ["tracking", "coasting", "lost"]
    assert [begin for begin, _, _ in stretches[1:]] == [end for _, end, _ in stretches[:-1]]  # without a hole
    assert stretches[2][1] - stretches[2][0] == pytest.approx(16 * 0.05)


def test_the_error_behind_the_approach_is_read_on_a_logarithmic_axis(tmp_path):
    """1 m too far at first, then 0.5 mm; and 20 frames without a measurement, where there is no curve."""
    writer = Writer(tmp_path / "run.log")
    for k in range(200):
        writer.frame(2.1 if k < 50 else None if 100 <= k < 120 else 1.1005)
        writer.passes()
    axes = draw_run_overview({"robot1": read_run(writer.file).robots["robot1"]}).axes[2]
    assert axes.get_yscale() == "log"
    _, values_mm = curve(axes, 0)
    assert values_mm[0] == pytest.approx(1000.0)
    assert values_mm[-1] == pytest.approx(0.5)
    assert np.isnan(values_mm).sum() == 1  # one break


def test_a_status_before_the_first_frame_is_not_in_the_legend(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for _ in range(5):
        writer.command(LOST, NO_FRAME)
        writer.wall_us += 50_000
    for _ in range(30):
        writer.frame()
        writer.passes()
    figure = draw_run_overview({"robot1": read_run(writer.file).robots["robot1"]})
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["tracking"]


def area(pieces):
    """Time by status: [s] where a piece has all of the band's height."""
    seconds = {}
    for piece in pieces:
        height = piece.top - piece.bottom
        seconds[piece.status] = seconds.get(piece.status, 0.0) + (piece.end_s - piece.begin_s) * height
    return seconds


def test_what_is_narrower_than_a_column_of_the_band_takes_its_part_of_the_height():
    """30 ms without a picture every 10 s of 100 s: 0.3 % of the time is 0.3 % of the area, however wide a column is."""
    stretches = []
    for k in range(10):
        stretches += [(10.0 * k, 10.0 * k + 9.97, "tracking"), (10.0 * k + 9.97, 10.0 * (k + 1), "coasting")]
    pieces = band_pieces(stretches, 0.0, 100.0, columns=400)
    assert area(pieces) == pytest.approx({"tracking": 99.7, "coasting": 0.3})
    # A column is 250 ms wide: 30 ms of it are 12 % of its height, and not all of it.
    assert max(piece.top - piece.bottom for piece in pieces if piece.status == "coasting") == pytest.approx(0.12)


def test_what_is_wider_than_a_column_has_all_of_the_height_of_the_band():
    pieces = band_pieces([(0.0, 50.0, "tracking"), (50.0, 100.0, "lost")], 0.0, 100.0, columns=400)
    assert [(p.begin_s, p.end_s, p.bottom, p.top, p.status) for p in pieces] == [
        (0.0, 50.0, 0.0, 1.0, "tracking"),
        (50.0, 100.0, 0.0, 1.0, "lost"),
    ]


def test_a_hole_in_the_recording_is_a_hole_in_the_band():
    pieces = band_pieces([(0.0, 10.0, "tracking"), (90.0, 100.0, "tracking")], 0.0, 100.0, columns=100)
    assert area(pieces) == pytest.approx({"tracking": 20.0})
    assert [(p.begin_s, p.end_s) for p in pieces] == [pytest.approx((0.0, 10.0)), pytest.approx((90.0, 100.0))]


def test_a_curve_that_lies_upon_another_leaves_it_to_be_seen(recorded):
    """The same run twice: the first is wide and whole, the second narrow and dashed, so both are seen."""
    robot = read_run(recorded.box).robots["robot1"]
    runs = {"first": robot, "second": robot}
    for figure, at in ((draw_run_overview(runs), 1), (draw_relative_view(runs), 0)):
        lines = [
            line
            for line in figure.axes[at].get_lines()
            if "first" in str(line.get_label()) or "second" in str(line.get_label())
        ]
        first, second = lines
        assert first.get_linestyle() == "-" and second.get_linestyle() == "--"
        assert first.get_linewidth() > 1.5 * second.get_linewidth()
        assert first.get_color() != second.get_color()


def test_from_above_the_leader_is_where_distance_and_bearing_put_it(recorded):
    robot = read_run(recorded.box).robots["robot1"]
    axes = draw_relative_view({"robot1": robot}).axes[0]
    right_m, forward_m = curve(axes)
    np.testing.assert_allclose(np.hypot(right_m, forward_m), robot.frames["distance_m"])
    # Positive bearing: to the left, so to the right is negative.
    np.testing.assert_allclose(np.arctan2(-right_m, forward_m), robot.frames["bearing_rad"])


def test_compared_runs_begin_together(recorded):
    runs = {name: read_run(path).robots["robot1"] for name, path in (("box", recorded.box), ("bus", recorded.bus))}
    axes = draw_run_overview(runs).axes[1]
    assert curve(axes, 1)[0][0] == curve(axes, 2)[0][0] == 0.0


def test_in_the_dark_the_ground_is_dark(recorded, tmp_path):
    robot = read_run(recorded.box).robots["robot1"]
    for draw in (draw_run_overview, draw_relative_view):
        pixels = np.asarray(Image.open(save(draw({"robot1": robot}, "x", DARK), tmp_path / "x.png")).convert("L"))
        assert np.median(pixels) < 40
        assert pixels.max() > 200


def test_a_run_without_a_leader_is_drawn(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame(None)
    robot = read_run(writer.file).robots["robot1"]
    save(draw_run_overview({"robot1": robot}), tmp_path / "a.png")
    save(draw_relative_view({"robot1": robot}), tmp_path / "b.png")


def test_where_nothing_was_measured_words_stand_instead_of_an_empty_axis(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for _ in range(30):
        writer.frame(None)
        writer.passes()
    runs = {"robot1": read_run(writer.file).robots["robot1"]}
    _, *panels = draw_run_overview(runs).axes
    words = [[text.get_text() for text in axes.texts] for axes in panels]
    cause = "the leader was never measured: no tag in the picture (all 30 frames)"
    assert words == [[cause], ["never measured"], ["never measured"], [], [], []]
    for axes in panels[:3]:
        assert not any(line.get_visible() for line in axes.get_lines())
        assert not any(label.get_visible() for label in axes.get_yticklabels())
    above = draw_relative_view(runs)
    assert [text.get_text().replace("\n", " ") for text in above.axes[0].texts] == [cause]
    # No name in the legend of what is not in the picture.
    assert [text.get_text() for text in above.legends[0].get_texts()] == ["the robot", "setpoint"]


def test_silence_is_named_with_its_length_in_the_strip_and_a_gap_that_lines_bridge_is_not():
    """Nothing for 4 s; then for 0.4 s, which a line bridges, too. What comes behind the last message is no silence:
    of two runs the shorter one is simply over."""
    assert silences([(0.0, 1.0, "tracking"), (5.0, 6.0, "lost"), (6.4, 7.0, "lost")]) == [(1.0, 5.0)]
    axes = Figure().subplots()
    draw_status_band(axes, [(0.0, 1.0, "tracking"), (5.0, 6.0, "lost")], 0.0, 0.8, (0.0, 20.0), "#000000")
    assert [text.get_text() for text in axes.texts] == ["no messages for 4.0 s"]
    (named,) = axes.patches
    assert (named.get_x(), named.get_width(), named.get_hatch()) == (1.0, 4.0, None)
    axes = Figure().subplots()  # 4 % of the width are no room for words: hatched, which the legend explains
    draw_status_band(axes, [(0.0, 1.0, "tracking"), (5.0, 6.0, "lost")], 0.0, 0.8, (0.0, 100.0), "#000000")
    assert ([patch.get_hatch() for patch in axes.patches], list(axes.texts)) == (["////"], [])
