"""``pilotfish fuzzy``: what it prints, what it ends with, what it leaves behind."""

import re

import fuzzy_reference
import pytest
import yaml
from matplotlib.image import imread
from typer.testing import CliRunner

from pilotfish import fuzzy
from pilotfish.cli import app

SHIPPED = fuzzy_reference.DATA

pytestmark = pytest.mark.usefixtures("small_pictures")


def run(*arguments):
    result = CliRunner().invoke(app, ["fuzzy", *(str(argument) for argument in arguments)])
    said = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    return result.exit_code, re.sub(r"[\s│┃]+", " ", said)


@pytest.fixture
def fll(controller, tmp_path):
    file = tmp_path / "law.fll"
    file.write_text(fuzzy.to_fll(controller))
    return file


@pytest.mark.parametrize("command", ["show", "check", "plot", "explain", "convert"])
def test_every_help_has_an_example_to_copy(command):
    code, said = run(command, "--help")
    assert code == 0
    assert f"pilotfish fuzzy {command} " in said


def test_show_prints_the_sets_the_table_and_the_figures(fll):
    for file in (SHIPPED, fll):
        code, said = run("show", file)
        assert code == 0
        assert "NZ triangle -0.3 -0.02 0.1 -0.02" in said
        assert "NZ PS PS ZE ZE ZE ZE NS" in said
        assert "slope of u(e, 0) at zero, left and right -2.786 -2.786" in said
        assert "dead zone of u(e, 0) none" in said


def test_check_passes_what_is_shipped(fll):
    for file in (SHIPPED, fll):
        code, said = run("check", file)
        assert (code, said.strip()) == (0, "no dead zone, no discontinuity, and every rule fires somewhere")


def test_check_ends_with_1_where_something_is_found(data, tmp_path):
    data["E"]["terms"] |= {"NM": {"triangle": [-0.8, -0.5, -0.5]}, "NS": {"trapezoid": [-0.5, -0.5, -0.3, 0.0]}}
    file = tmp_path / "jump.yaml"
    file.write_text(yaml.safe_dump(data, sort_keys=False))
    code, said = run("check", file)
    assert code == 1
    assert re.search(r"found discontinuity: u jumps by 0\.\d+ at E = -0\.5", said)


def test_check_ends_with_78_and_the_place_where_a_file_cannot_be_used(data, fll, tmp_path):
    data["E"]["terms"]["PM"] = {"triangle": [0.55, 0.6, 0.8]}
    file = tmp_path / "hole.yaml"
    file.write_text(yaml.safe_dump(data, sort_keys=False))
    code, said = run("check", file)
    assert code == 78
    assert "E.terms: no term covers 0.5" in said
    fll.write_text(fll.read_text().replace("PS Triangle", "PS Bell", 1))
    code, said = run("check", fll)
    assert code == 78
    assert "term 'PS': Bell is not supported" in said


def test_plot_writes_three_pictures(fll, tmp_path):
    code, said = run("plot", fll, "--out", tmp_path / "out")
    assert code == 0
    for kind in ("sets", "surface", "curve"):
        picture = tmp_path / "out" / f"law_{kind}.png"
        assert str(picture) in said.replace(" ", "") or picture.name in said
        assert imread(picture).std() > 0.02  # not a blank sheet


def test_explain_says_why_and_draws_it(tmp_path):
    picture = tmp_path / "why.png"
    code, said = run("explain", SHIPPED, "--e", "-0.2", "--ec", "0.1", "--out", picture)
    assert code == 0
    assert "IF E is NS AND EC is ZE THEN U is PM 0.6667" in said
    assert "U = +0.3187, the centroid of ZE at 0.36, PM at 0.67" in said
    assert imread(picture).std() > 0.02
    _, wide = run("explain", SHIPPED, "--e", "-0.2", "--ec", "0.1", "--width-error-change", "0.5")
    assert "EC is NS" in wide and "EC is NS" not in said  # a wide B' reaches NS


def test_an_input_beyond_its_universe_is_explained_with_a_warning_and_as_its_end():
    code, said = run("explain", SHIPPED, "--e", "7", "--ec", "-2")
    assert code == 0
    assert "warning: E = 7 is beyond its universe and counts as 1" in said
    assert "warning: EC = -2 is beyond its universe and counts as -1" in said
    table = said[said.index("IF ") :]
    assert table in run("explain", SHIPPED, "--e", "1", "--ec", "-1")[1]


def test_convert_there_and_back_changes_nothing(controller, tmp_path):
    there, back = tmp_path / "sub" / "law.fll", tmp_path / "law.yaml"
    assert run("convert", SHIPPED, there)[0] == 0
    assert run("convert", there, back)[0] == 0
    assert fuzzy.to_fll(fuzzy.load_controller(back)) == fuzzy.to_fll(controller)


@pytest.mark.parametrize(
    ("arguments", "wrong"),
    [
        (["convert", SHIPPED, "law.txt"], ".txt"),
        (["explain", SHIPPED], "--e"),
        (["explain", SHIPPED, "--e", "0", "--width-error", "-1"], "--width-error"),
    ],
)
def test_a_wrong_command_line_ends_with_64_and_says_which_word_is_wrong(arguments, wrong):
    code, said = run(*arguments)
    assert code == 64
    assert wrong in said


@pytest.mark.parametrize("option", ["--e", "--ec"])
@pytest.mark.parametrize("value", ["nan", "inf"])
def test_nobody_can_say_why_of_what_is_no_number(option, value):
    code, said = run("explain", SHIPPED, "--e", "0.1", option, value)
    assert code == 64
    assert f"{value} is not a number" in said


@pytest.mark.parametrize(
    "arguments", [("convert", SHIPPED), ("plot", SHIPPED, "--out"), ("explain", SHIPPED, "--e", "0.1", "--out")]
)
def test_a_file_that_cannot_be_written_is_named_without_a_traceback(arguments, tmp_path):
    (tmp_path / "file").write_text("not a folder")
    code, said = run(*arguments, tmp_path / "file" / ("why.png" if "explain" in arguments else "law.fll"))
    assert code == 74
    assert str(tmp_path / "file").replace(" ", "") in said.replace(" ", "")
    assert "Traceback" not in said
