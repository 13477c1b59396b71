"""The pictures exist, are not empty and say what their axes are."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image
from synthetic_run import exponential_run

from pilotfish import data, fuzzy
from pilotfish.camera_view import CameraView
from pilotfish.plots.camera_gif import MAX_BYTES, WIDTH_PX, draw_camera_gif, draw_view
from pilotfish.plots.comparison import draw_comparison
from pilotfish.plots.distance_error import draw_distance_error
from pilotfish.plots.fuzzy_sets import draw_fuzzy_sets
from pilotfish.plots.overview import Summary, draw_overview
from pilotfish.plots.paths import draw_paths
from pilotfish.plots.style import save
from pilotfish.plots.surface import draw_surface


def labels(figure: Figure) -> set[str]:
    return {text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left"))}


def colours_of(file) -> int:
    return len(np.unique(np.asarray(Image.open(file).convert("RGB")).reshape(-1, 3), axis=0))


def test_the_distance_error_is_drawn_with_its_steady_state_error(tmp_path):
    figure = draw_distance_error(exponential_run(), "A line")
    assert {"A line", "distance error e [m]", "distance d [m]", "time [s]"} <= labels(figure)
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


def test_in_a_chain_a_leader_that_is_itself_recorded_is_drawn_once():
    first = exponential_run()
    second = exponential_run(robot="robot2", leader="robot1")
    names = [text.get_text() for text in draw_paths([first, second], "").legends[0].get_texts()]
    assert names.count("leader (leads)") == 1
    assert not any("robot1 (leads)" in name for name in names)


def view(time_s: float, **changes) -> CameraView:
    corners = np.array([[100.0, 200.0], [200.0, 200.0], [200.0, 100.0], [100.0, 100.0]])
    image = np.random.default_rng(round(10 * time_s)).integers(0, 256, (480, 640), dtype=np.uint8)
    values = {"status": "tracking", "tags": ((7, corners),), "distance_m": 1.1, "bearing_rad": -0.1745}
    return CameraView(time_s=time_s, image=image, **(values | changes))


def test_the_outline_of_a_tag_is_drawn_around_the_tag():
    # 640 -> 480 is 3/4: the edge from (100, 200) to (200, 200) lies at y = 0.75 * 200.5 - 0.5 + 30 = 179.9.
    seen = np.asarray(draw_view(view(0.0))).astype(int)
    red = (np.abs(seen - (0xD5, 0x5E, 0x00)).sum(axis=2) < 30).nonzero()
    rows, columns = red
    on_the_edge = columns[(rows == 180) & (columns > 80) & (columns < 145)]
    assert len(on_the_edge) == 64
    # Nothing was seen, nothing is drawn.
    empty = np.asarray(draw_view(view(0.0, tags=(), distance_m=None, bearing_rad=None, status="lost"))).astype(int)
    assert (np.abs(empty - (0xD5, 0x5E, 0x00)).sum(axis=2) < 30).sum() == 0


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
    runs = {"paper": exponential_run(), "anticipate": exponential_run(seconds=10.0), "mine": exponential_run()}
    figure = draw_comparison({"A line": runs, "A circle": runs})
    assert len(figure.axes) == 6
    assert {"A line", "A circle", "distance error e [m]", "bearing error [°]", "time [s]"} <= labels(figure)
    for axes in figure.axes:
        assert {line.get_label() for line in axes.lines} >= {"paper", "anticipate", "mine"}
        assert len({line.get_color() for line in axes.lines}) == 4  # three laws and zero
    assert colours_of(save(figure, tmp_path / "comparison.png")) > 20


def test_the_overview_has_a_row_an_experiment(tmp_path):
    runs = {"paper": exponential_run(), "anticipate": exponential_run()}
    summaries = [Summary(name, runs, view(3.0)) for name in ("A line", "A circle")]
    figure = draw_overview(summaries)
    assert len(figure.axes) == 6
    assert {"A line", "A circle", "From above (anticipate)", "What the camera of robot1 saw", "x [m]"} <= labels(figure)
    assert colours_of(save(figure, tmp_path / "overview.png")) > 20


@pytest.fixture(scope="module")
def law():
    return fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))


def test_every_fuzzy_set_is_drawn_once_and_named(law, tmp_path):
    figure = draw_fuzzy_sets(law)
    assert [axes.get_ylabel() for axes in figure.axes] == ["degree, E", "degree, EC", "degree, U"]
    for axes, variable in zip(figure.axes, (law.error, law.error_change, law.output), strict=True):
        assert [text.get_text() for text in axes.texts] == variable.labels
        assert len(axes.lines) == len(variable.terms)
    assert colours_of(save(figure, tmp_path / "sets.png")) > 20


def test_the_surface_and_its_section_at_ec_zero_are_drawn(law, tmp_path):
    figure = draw_surface(law)
    solid, section = figure.axes
    assert (solid.get_xlabel(), solid.get_ylabel(), solid.get_zlabel()) == ("e", "ec", "u")
    (line,) = [line for line in section.lines if line.get_label() == "ec = 0"]
    # The section is the law itself: zero at zero, and its sign is the error's, reversed.
    e, u = line.get_data()
    assert u[e == 0.0] == pytest.approx(fuzzy.infer(law, 0.0, 0.0).output)
    assert (u[e < -0.1] > 0).all()
    assert (u[e > 0.1] < 0).all()
    assert colours_of(save(figure, tmp_path / "surface.png")) > 20
