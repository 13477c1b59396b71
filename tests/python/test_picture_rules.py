"""What holds for every picture: units, lines that can be told apart, names as README's, colours for all eyes."""

import itertools
import re
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pypdfium2
import pytest
from every_picture import DRAW, LAWS, drawn, runs
from matplotlib.axis import Tick
from matplotlib.collections import Collection
from matplotlib.colors import to_hex, to_rgb, to_rgba_array
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text
from PIL import Image

from pilotfish.plots.comparison import draw_comparison
from pilotfish.plots.laws import law_styles
from pilotfish.plots.style import DARK, LIGHT, save

README = (Path(__file__).parents[2] / "README.md").read_text()
EVERY_PICTURE = pytest.mark.parametrize("which", DRAW)
BOTH_LOOKS = pytest.mark.parametrize("theme", [LIGHT, DARK], ids=lambda theme: theme.name)

# Words, then the unit in brackets; "[-]" for a number without one.
LABEL = re.compile(r"^\w.*\[(m|mm|s|Hz|m/s|°|°/s|-)\]", re.DOTALL)


@pytest.fixture(scope="module")
def as_png(tmp_path_factory, small_pictures):
    """Draws and writes a picture, once for all tests: (which, theme) -> figure, file."""
    folder = tmp_path_factory.mktemp("pictures")

    @cache
    def write(which, theme):
        figure = light(which) if theme is LIGHT else drawn(which, theme)
        return figure, save(figure, folder / f"{which}_{theme.name}.png")

    return write


@cache
def light(which):
    """The picture, drawn once for all tests that only look at what is in it."""
    return drawn(which)


def labels_of(axes):
    """The labels an axes must have: not those of an axis without tick labels, which it shares with one below it."""
    if axes.get_label() == "<colorbar>":
        return [axes.get_ylabel()]
    shown = [axes.get_xlabel()] if any(text.get_visible() for text in axes.get_xticklabels()) else []
    three = [axes.get_zlabel()] if hasattr(axes, "get_zlabel") else []
    return [*shown, axes.get_ylabel(), *three, *(child.get_ylabel() for child in axes.child_axes)]


@EVERY_PICTURE
def test_every_axis_says_what_it_shows_and_in_which_unit(which):
    axes = [axes for axes in light(which).axes if axes.axison]
    assert axes
    for label in itertools.chain.from_iterable(map(labels_of, axes)):
        assert LABEL.match(label), f"'{label}'"


@EVERY_PICTURE
def test_no_two_named_lines_of_an_axes_look_the_same(which):
    for axes in light(which).axes:
        named = [line for line in axes.lines if not line.get_label().startswith("_")]
        looks = [(line.get_color(), line._unscaled_dash_pattern, line.get_marker()) for line in named]
        assert len(set(looks)) == len(looks)


def seen_colour(line):
    """The caps of error bars are markers without a line, whose own colour nobody sees."""
    return line.get_markeredgecolor() if line.get_linestyle() == "None" else line.get_color()


def test_what_has_no_name_is_gray_or_a_mark_of_a_named_line():
    for which in DRAW:
        for axes in light(which).axes:
            named = {line.get_color() for line in axes.lines if not line.get_label().startswith("_")}
            bars = [each for each in axes.containers if not each.get_label().startswith("_")]
            named |= {each.lines[0].get_color() for each in bars if hasattr(each, "lines") and each.lines[0]}
            unnamed = [line for line in axes.lines if line.get_label().startswith("_")]
            ours = {LIGHT.guide, LIGHT.ink, LIGHT.measured}  # ink and orange: the explained inputs and output
            assert all(seen_colour(line) in ours | named for line in unnamed), which


def test_the_legend_names_the_laws_as_readme_does():
    (header,) = re.findall(r"^\| RMS distance error \[mm\], leader at .*$", README, flags=re.MULTILINE)
    names = [cell.strip().removesuffix(", tuned") for cell in header.strip("| ").split("|")][1:]
    assert len(names) == 4
    for figure in (draw_comparison({"A line": runs(*LAWS)}), light("overview")):
        legend = [text.get_text() for text in figure.legends[0].get_texts()]
        assert set(names) <= set(legend)
        assert not {"pbvs", "pid"} & set(legend)


def test_a_law_has_one_colour_in_all_pictures():
    for which in ("one run", "paths", "comparison", "overview"):
        colours = {line.get_color() for axes in light(which).axes for line in axes.lines}
        assert LIGHT.paper in colours or which == "overview"
    # In the overview the path is that of the law that drove it last, and so is its colour.
    paths = light("overview").axes[0]
    assert {line.get_color() for line in paths.lines} == {LIGHT.anticipate, LIGHT.ink}


def test_where_lines_meet_the_wide_one_lies_below_and_the_dots_on_top():
    order = [law_styles([law])[law] for law in ("anticipate", "paper", "pbvs", "pid")]
    assert [style.zorder for style in order] == sorted(style.zorder for style in order)
    assert order[0].width_pt > max(style.width_pt for style in order[1:])
    assert len({style.dashes for style in order}) == 4  # also in gray


# Contrast of WCAG 2.1: (L1 + 0.05) / (L2 + 0.05) of relative luminances.
def linear(colour):
    rgb = np.array(to_rgb(colour))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def contrast(one, other):
    low, high = sorted(float(linear(colour) @ (0.2126, 0.7152, 0.0722)) for colour in (one, other))
    return (high + 0.05) / (low + 0.05)


@EVERY_PICTURE
@BOTH_LOOKS
def test_every_text_and_tick_stands_out_from_the_ground(which, theme, as_png):
    figure, _ = as_png(which, theme)
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    assert len(texts) > 5
    assert min(contrast(text.get_color(), theme.ground) for text in texts) >= 4.5
    ticks = [tick.tick1line for tick in figure.findobj(Tick)]  # also minor ones, which are made when they are drawn
    assert min(contrast(line.get_color(), theme.ground) for line in ticks) >= 4.5


@EVERY_PICTURE
def test_a_dark_picture_has_no_colour_of_the_light_ones(which, as_png):
    figure, _ = as_png(which, DARK)
    light = {value.lower() for value in vars(LIGHT).values() if str(value).startswith("#")}
    marks = [mark for kind in (Line2D, Collection, Patch) for mark in figure.findobj(kind) if mark.get_visible()]
    colours = [mark.get_color() if isinstance(mark, Line2D) else mark.get_facecolor() for mark in marks]
    drawn_in = {to_hex(colour) for colour in np.concatenate([to_rgba_array(own) for own in colours]) if colour[3] > 0.0}
    assert drawn_in and not drawn_in & light


def test_in_the_dark_every_colour_stands_out_from_the_ground():
    colours = (DARK.anticipate, DARK.paper, DARK.pbvs, DARK.pid, DARK.other_law, DARK.measured, DARK.ink, DARK.guide)
    assert min(contrast(colour, DARK.ground) for colour in colours) >= 4.5


# Machado, Oliveira, Fernandes, "A Physiologically-based Model for Simulation of Color Vision Deficiency" (2009),
# severity 1.0; on linear RGB.
SEEN_BY = {
    "all": np.eye(3),
    "protanopes": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopes": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopes": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour, matrix):
    """CIE L*a*b* (D65) of a colour as seen through ``matrix``."""
    ratios = TO_XYZ @ np.clip(np.asarray(matrix) @ linear(colour), 0.0, 1.0) / TO_XYZ.sum(axis=1)
    f = np.where(ratios > (6 / 29) ** 3, np.cbrt(ratios), ratios / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@BOTH_LOOKS
@pytest.mark.parametrize("eyes", SEEN_BY)
def test_colour_blind_readers_tell_the_laws_and_the_leader_apart(theme, eyes):
    """2.3 is a just noticeable difference of CIE76; five of them between any two."""
    colours = [theme.anticipate, theme.paper, theme.pbvs, theme.pid, theme.ink, theme.guide]
    seen = [lab(colour, SEEN_BY[eyes]) for colour in colours]
    assert min(np.linalg.norm(a - b) for a, b in itertools.combinations(seen, 2)) > 11.5


@EVERY_PICTURE
def test_dark_and_light_pictures_differ(which, as_png):
    files = {theme.name: as_png(which, theme)[1] for theme in (LIGHT, DARK)}
    levels = {name: np.median(np.asarray(Image.open(file).convert("L"))) for name, file in files.items()}
    assert levels["light"] == 255
    assert levels["dark"] < 40


@EVERY_PICTURE
def test_svg_is_xml_whose_text_is_text(which, as_png, tmp_path):
    figure, _ = as_png(which, LIGHT)
    figure.set_layout_engine("none")  # it has been laid out, which takes several times as long with the letters of SVG
    root = ElementTree.parse(save(figure, tmp_path / "picture.svg")).getroot()
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    texts = {"".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text")}
    said = {
        text.get_text()
        for text in figure.findobj(Text)
        if text.get_visible() and re.match(r"^\w[^$\n]+\[[^\n]+$", text.get_text())
    }
    assert said and said <= texts


def test_the_same_picture_is_the_same_svg(tmp_path):
    one, other = (save(drawn("one run"), tmp_path / f"{name}.svg").read_bytes() for name in "ab")
    assert one == other


def test_in_pdf_text_is_text(tmp_path):
    with pypdfium2.PdfDocument(save(drawn("one run"), tmp_path / "picture.pdf")) as document:
        page = document[0]
        said = page.get_textpage().get_text_range()
    assert "distance error e [m]" in said and "time [s]" in said
    assert b"/Subtype /Type3" not in (tmp_path / "picture.pdf").read_bytes()  # drawings of letters
