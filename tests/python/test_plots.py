"""The pictures exist, are not empty and say what their axes are."""

import numpy as np
import pytest
from every_picture import chain, runs, view
from matplotlib.figure import Figure
from PIL import Image
from synthetic_run import exponential_run, synthetic_run

from pilotfish import data, fuzzy, sim
from pilotfish.plots.camera_gif import MAX_BYTES, WIDTH_PX, draw_camera_gif, draw_seen, draw_view, measured_texts
from pilotfish.plots.comparison import draw_comparison
from pilotfish.plots.distance_error import draw_distance_error
from pilotfish.plots.fuzzy_sets import draw_fuzzy_sets
from pilotfish.plots.obstacles import draw_among_obstacles
from pilotfish.plots.overview import Summary, draw_overview
from pilotfish.plots.paths import draw_paths
from pilotfish.plots.style import LIGHT, save
from pilotfish.plots.surface import draw_surface
from pilotfish.plots.traces import running_rms


def labels(figure: Figure) -> set[str]:
    return {text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left"))}


def colours_of(file) -> int:
    return len(Image.open(file).convert("RGB").getcolors(1 << 24))


def test_the_distance_error_is_drawn_with_its_steady_state_error(tmp_path):
    figure = draw_distance_error(exponential_run(), "A line")
    assert {"A line", "distance error e [m]", "e, magnified\n[mm]", "bearing error\n[°]", "time [s]"} <= labels(figure)
    legend = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert "steady-state error -100 mm" in legend
    assert "settled after 4.9 s" in legend
    assert colours_of(save(figure, tmp_path / "error.png")) > 20


def test_a_run_that_did_not_settle_is_drawn_without_a_settling_time():
    run = exponential_run(seconds=2.0)
    legend = [text.get_text() for text in draw_distance_error(run, "").axes[0].get_legend().get_texts()]
    assert not any("settled" in text for text in legend)


def test_the_paths_are_drawn_to_scale(tmp_path):
    figure = draw_paths([exponential_run()], "From above")
    axes = figure.axes[0]
    assert {"From above", "x [m]", "y [m]"} <= labels(figure)
    assert axes.get_aspect() == 1.0
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"leader (leads)", "robot1 (follows leader by sight)"} <= set(names)
    assert colours_of(save(figure, tmp_path / "paths.png")) > 20


def test_among_obstacles_the_legend_names_whatever_is_in_the_picture():
    """Two robots; one obstacle hides them and one does not, being lower than the line of sight at 0.25 m."""
    robots = [exponential_run(), exponential_run(robot="robot2", leader="robot1")]
    obstacles = [sim.Obstacle(x_m=1.0, y_m=1.0, radius_m=0.1, height_m=height_m) for height_m in (1.0, 0.1)]
    figure = draw_among_obstacles(robots, iter(obstacles), "")
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"obstacle", "low obstacle: hides nobody", "robot's outline, every 4 s"} < set(names)
    assert [text.get_text() for text in figure.axes[0].texts] == ["robot1", "robot2"]
    high = draw_among_obstacles(robots, obstacles[:1], "")
    assert not any("low obstacle" in text.get_text() for text in high.legends[0].get_texts())  # there is none


def test_in_a_chain_a_leader_that_is_itself_recorded_is_drawn_once():
    first = exponential_run()
    second = exponential_run(robot="robot2", leader="robot1")
    names = [text.get_text() for text in draw_paths([first, second], "").legends[0].get_texts()]
    assert names.count("leader (leads)") == 1
    assert not any("robot1 (leads)" in name for name in names)


ORANGE = (0xE6, 0x9F, 0x00)  # what the camera measured


def test_the_outline_of_a_tag_is_drawn_around_the_tag():
    # 640 -> 480 is 3/4: the edge from (100, 200) to (200, 200) lies at y = 0.75 * 200.5 - 0.5 + 30 = 179.9.
    seen = np.asarray(draw_view(view(0.0))).astype(int)
    rows, columns = (np.abs(seen - ORANGE).sum(axis=2) < 30).nonzero()
    on_the_edge = columns[(rows == 180) & (columns > 80) & (columns < 145)]
    assert len(on_the_edge) == 64
    # Nothing was seen, nothing is drawn.
    empty = np.asarray(draw_view(view(0.0, tags=(), distance_m=None, bearing_rad=None, status="lost"))).astype(int)
    assert (np.abs(empty - ORANGE).sum(axis=2) < 30).sum() == 0


def test_the_gif_moves_loops_and_stays_small_even_if_the_pictures_are_noise(tmp_path):
    file = draw_camera_gif([view(0.2 * i) for i in range(40)], tmp_path / "camera.gif", "Line")
    with Image.open(file) as gif:
        assert gif.n_frames == 40
        assert gif.info["loop"] == 0
        assert gif.size[0] == WIDTH_PX
        assert len(gif.convert("RGB").getcolors(1 << 20)) > 5
    assert file.stat().st_size <= MAX_BYTES


def test_a_gif_of_nothing_is_refused(tmp_path):
    with pytest.raises(ValueError, match="at least one"):
        draw_camera_gif([], tmp_path / "camera.gif")


def test_a_comparison_has_a_column_an_experiment_and_a_line_a_law(tmp_path):
    of_three = {"paper": exponential_run(), "anticipate": exponential_run(seconds=10.0), "mine": exponential_run()}
    figure = draw_comparison({"A line": of_three, "A circle": of_three})
    assert len(figure.axes) == 10
    assert {"A line", "A circle", "distance error e [m]", "bearing error [°]", "time [s]"} <= labels(figure)
    for axes in figure.axes:
        assert {line.get_label() for line in axes.lines} >= {"paper", "anticipate", "mine"}
        assert len({line.get_color() for line in axes.lines} - {LIGHT.guide}) == 3
    assert colours_of(save(figure, tmp_path / "comparison.png")) > 20


def test_the_overview_has_a_column_an_experiment(tmp_path):
    summaries = [Summary(name, runs("paper", "anticipate"), view(3.0)) for name in ("A line", "A circle")]
    figure = draw_overview(summaries)
    assert len(figure.axes) == 12
    assert {"From above (anticipate)", "What the camera of robot1 saw", "x [m]"} <= labels(figure)
    assert [column.get_suptitle() for column in figure.subfigs] == ["A line", "A circle"]
    said = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert said == ["t = 3.0 s,   d = 1.100 m,   θ = -10.0°"] * 2
    assert colours_of(save(figure, tmp_path / "overview.png")) > 20


def test_the_dots_lie_behind_the_true_curve():
    _, magnified, bearing, *_ = draw_distance_error(exponential_run(), "").axes
    for axes in (magnified, bearing):
        order = {line.get_label(): line.get_zorder() for line in axes.lines}
        assert order["measured by the camera"] < order["true"]


def test_the_magnified_error_shows_the_steady_state_with_its_measurements():
    # From 10 s on e rises from -100 - 1300 exp(-10 / 1.5) = -101.65 mm to -100.00, and is measured 1 mm farther, from
    # -102.65 mm: a span of 2.65 mm, and half of it as a margin on either side.
    limits_mm = draw_distance_error(exponential_run(), "").axes[1].get_ylim()
    assert limits_mm == pytest.approx((-102.65 - 1.33, -100.0 + 1.33), abs=0.02)


def test_a_run_in_which_nothing_was_measured_is_drawn_without_dots():
    figure = draw_distance_error(exponential_run().with_measurements({}), "")
    assert not any(line.get_label() == "measured by the camera" for axes in figure.axes for line in axes.lines)


def test_the_distance_on_the_right_is_the_setpoint_less_the_error():
    error = draw_distance_error(exponential_run(), "").axes[0]
    (distance,) = error.child_axes
    error.figure.draw_without_rendering()
    for error_m, distance_m in ((0.0, 1.0), (-1.0, 2.0)):  # d = d_p - e, d_p = 1 m: at the same height
        height_px = error.transData.transform((0.0, error_m))[1]
        assert distance.transData.transform((0.0, distance_m))[1] == pytest.approx(height_px)


def test_the_running_rms_is_that_of_the_samples_around():
    rng = np.random.default_rng(3)
    time_s = np.cumsum(rng.uniform(0.01, 0.05, 200))
    values = rng.normal(size=200)
    around = [values[np.abs(time_s - t) <= 0.25 + 1e-9] for t in time_s]
    assert running_rms(time_s, values, 0.5) == pytest.approx([np.sqrt((own @ own) / len(own)) for own in around])
    assert running_rms(time_s, np.full(200, -2.0), 0.5) == pytest.approx(2.0)


def test_millimetres_are_read_beside_metres():
    """A law that stands at -100 mm and one that stands at -0.02 mm are both on the axis, decades apart."""
    near = exponential_run(profile="pid")
    near = near.with_meta(distance_setpoint_m=near.meta.distance_setpoint_m + 0.1 - 0.00002)
    axes = draw_comparison({"A line": {"paper": exponential_run(), "pid": near}}).axes[1]
    assert axes.get_yscale() == "log"
    ends_mm = {line.get_label(): line.get_ydata()[-1] for line in axes.lines}
    assert ends_mm["paper"] == pytest.approx(100.0, rel=1e-3)
    # 0.02 mm, and of 1300 exp(-t / 1.5) mm what is left in the last 0.25 s of 20: 0.0021 to 0.0025.
    assert ends_mm["PID"] == pytest.approx(0.0223, abs=0.0002)
    assert axes.get_ylim()[0] < 0.02 and axes.get_ylim()[1] > 100.0


def test_an_error_of_exactly_zero_is_on_the_logarithmic_axis_as_well():
    still = synthetic_run(np.arange(60) / 30.0, np.zeros(60), profile="pid")
    axes = draw_comparison({"A line": {"pid": still}}).axes[1]
    (line,) = axes.lines
    assert np.isfinite(line.get_ydata()).all() and (line.get_ydata() > 0.0).all()


def test_the_robots_of_a_chain_have_one_colour_and_different_dashes():
    axes = draw_paths(chain(), "").axes[0]
    followers = [line for line in axes.lines if "follows" in line.get_label()]
    assert len(followers) == 3
    assert len({line.get_color() for line in followers}) == 1
    assert len({line._unscaled_dash_pattern for line in followers}) == 3


def test_a_bearing_of_nothing_has_no_sign():
    assert measured_texts(view(0.0, bearing_rad=-1e-5)) == ["d = 1.100 m", "θ = 0.0°"]
    assert measured_texts(view(0.0, bearing_rad=-0.1745))[1] == "θ = -10.0°"
    assert measured_texts(view(0.0, distance_m=None, bearing_rad=None)) == []


def test_a_title_that_does_not_fit_beside_the_measurements_gives_way():
    # Left of the middle of the bar: nothing but the time, for a title as long as the picture is wide.
    plain, long, short = (np.asarray(draw_view(view(0.0), title))[:30] for title in ("", "long " * 20, "Line"))
    assert (plain == long).all()
    assert (plain != short).any()


def test_the_picture_without_a_bar_is_the_rest_of_the_one_with_it():
    assert (np.asarray(draw_view(view(0.0)))[30:] == np.asarray(draw_seen(view(0.0)))).all()


@pytest.fixture(scope="module")
def law():
    return fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))


def test_every_fuzzy_set_is_drawn_once_and_named(law, tmp_path):
    figure = draw_fuzzy_sets(law)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        f"{name}: degree of membership [-]" for name in ("E", "EC", "U")
    ]
    for axes, variable in zip(figure.axes, (law.error, law.error_change, law.output), strict=True):
        assert [text.get_text() for text in axes.texts] == variable.labels
        assert len(axes.lines) == len(variable.terms)
    assert colours_of(save(figure, tmp_path / "sets.png")) > 20


def test_a_set_is_drawn_down_to_its_feet_and_no_further(law):
    # At most one sample of degree zero at either foot; the rest of the base line is free.
    for axes in draw_fuzzy_sets(law).axes:
        for line in axes.lines:
            degrees = line.get_ydata()
            assert (degrees == 0.0).sum() <= 2
            assert np.nanmax(degrees) == pytest.approx(1.0, abs=0.05)
            assert np.isnan(degrees).any()


def test_the_surface_and_its_section_at_ec_zero_are_drawn(law, tmp_path):
    figure = draw_surface(law)
    solid, bar, section = figure.axes
    assert [label.split(" [")[0] for label in (solid.get_xlabel(), solid.get_ylabel(), solid.get_zlabel())] == [
        "distance error e",
        "change of the error ec",
        "velocity u",
    ]
    assert bar.get_ylabel() == solid.get_zlabel()
    assert bar.get_ylim() == (-1.0, 1.0)
    (line,) = [line for line in section.lines if line.get_label() == "ec = 0"]
    # The section is the law itself: zero at zero, and its sign is the error's, reversed.
    e, u = line.get_data()
    assert u[e == 0.0] == pytest.approx(fuzzy.infer(law, 0.0, 0.0).output)
    assert (u[e < -0.1] > 0).all()
    assert (u[e > 0.1] < 0).all()
    assert colours_of(save(figure, tmp_path / "surface.png")) > 20


def test_a_long_title_stays_inside_the_picture():
    title = "Leader on a circle, non-ideal robot, anticipate (the paper's Fig. 7, simulated)"
    figure = draw_distance_error(exponential_run(), title)
    figure.canvas.draw()
    extent = figure.axes[0].title.get_window_extent()
    left = figure.axes[0]._left_title.get_window_extent()
    assert max(extent.x1, left.x1) <= figure.bbox.x1 and min(extent.x0, left.x0) >= 0
    assert " ".join(figure.axes[0].get_title(loc="left").split()) == title
