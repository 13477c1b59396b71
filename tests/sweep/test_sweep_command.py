"""``pilotfish sweep``: from a file to results, tables and pictures; and what it says where that cannot be."""

import re
import sys

import pytest
from typer.testing import CliRunner

from pilotfish.cli import app
from pilotfish.recording import Recording
from sweep.campaigns import SPEED, rows, written

SAMPLED = {
    "runs": 1,
    "factors": {"law": ["paper", "pid"], SPEED: {"uniform": [0.1, 0.2]}},
    "sampling": {"method": "sobol", "points": 16},
}

pytestmark = pytest.mark.usefixtures("small_pictures")


def run(*words):
    result = CliRunner().invoke(app, ["sweep", *map(str, words)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, re.sub(r"\x1b\[[0-9;]*m|\s+", " ", result.output)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A sampled campaign, run: 2 laws, 16 x 3 samples."""
    folder = tmp_path_factory.mktemp("done")
    file = written(folder, **SAMPLED)
    code, said = run(file, "--out", folder / "out", "--workers", 0)
    assert (code, "96 of 96 runs done, 96 now (96 ok)" in said) == (0, True), said
    return file, folder / "out"


def test_the_same_command_again_has_nothing_left_to_do(done):
    file, out = done
    assert run(file, "--out", out, "--workers", 0) == (0, run(file, "--out", out, "--workers", 0)[1])
    assert "96 of 96 runs are done" in run("run", file, "--out", out, "--workers", 0)[1]


def test_check_counts_the_runs_and_writes_nothing(tmp_path):
    code, said = run(written(tmp_path, **SAMPLED), "--check", "--out", tmp_path / "out")
    assert code == 0 and "96 runs of 1 s (96 points of law, speed_mps; 1 run each)" in said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_pictures_and_tables_come_of_the_results(done, tmp_path, ending):
    _, out = done
    picture = tmp_path / f"new/picture.{ending}"
    assert run("plot", out, "--over", "speed_mps", "--by", "law", "--log", "--out", picture)[0] == 0
    assert picture.stat().st_size > 5000
    picture.unlink()
    code, said = run("sensitivity", out, "--by", "law", "--out", picture)
    assert code == 0 and picture.exists()
    assert said.count(SPEED) == 2  # a table for each law


def test_a_report_counts_compares_and_names_the_worst(done, tmp_path):
    _, out = done
    code, said = run("report", out, "--by", "law", "--where", "law=pid", "--csv", tmp_path / "all.csv")
    assert code == 0 and "48 runs: 48 ok" in said
    worst = max((row for row in rows(out) if row["law"] == "pid"), key=lambda row: row["rms_distance_mm"])
    assert f"run {worst['run']}: {worst['rms_distance_mm']:.4g}, ok; law pid" in said
    assert len((tmp_path / "all.csv").read_text().splitlines()) == 49


def test_one_run_can_be_had_whole_again(done, tmp_path):
    file, out = done
    row = rows(out)[60]
    code, said = run("rerun", file, 60, "--out", tmp_path / "run.csv")
    assert code == 0 and "law: pid" in said
    recording = Recording.from_csv(tmp_path / "run.csv")
    assert recording.true_distance_m.min() == row["min_distance_m"]
    assert run("rerun", file, 96, "--out", tmp_path / "run.csv")[0] == 64


def test_the_format_is_described():
    code, said = run("--describe")
    assert code == 0 and said.startswith("# A campaign's file")


WRONG = {
    "no such file": (["none.yaml"], 66, "none.yaml"),
    "two places": (["{file}", "--workers", "1", "--scheduler", "tcp://a:1"], 64, "give one of the two"),
    "no results": (["report", "{tmp}"], 66, "no folder of a campaign"),
    "factor": (["plot", "{out}", "--over", "sped"], 64, "no factor 'sped'"),
    "figure": (["plot", "{out}", "--over", "law", "--metric", "rms"], 64, "no figure 'rms'"),
    "ending": (["plot", "{out}", "--over", "law", "--out", "a.gif"], 64, "ends in none of .png, .svg, .pdf"),
    "where": (["plot", "{out}", "--over", "law", "--where", "law=fuzzy"], 64, "law is paper, pid"),
    "a sampled by": (["sensitivity", "{out}", "--by", "speed_mps"], 64, "it is sampled"),
    "log": (["plot", "{out}", "--over", "law", "--metric", "failed_percent", "--log"], 64, "not above 0 everywhere"),
}


@pytest.mark.parametrize(("words", "code", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_ends_with_its_exit_code_and_what_to_do(done, tmp_path, words, code, said):
    file, out = done
    ended, told = run(*(word.format(file=file, out=out, tmp=tmp_path) for word in words))
    assert ended == code, told
    assert said in told.replace(" │ │ ", " ")


@pytest.mark.parametrize(
    "words",
    [
        ["plot", "{out}", "--over", "speed_mps", "--metric", "settling_s", "--out", "{tmp}/a.png"],
        ["report", "{out}", "--by", "law", "--metric", "settling_s"],
        ["sensitivity", "{out}", "--by", "law", "--metric", "settling_s", "--out", "{tmp}/a.png"],
        ["sensitivity", "{out}", "--by", "law", "--metric", "settling_s", "--log", "--out", "{tmp}/a.png"],
    ],
    ids=["plot", "report", "sensitivity", "of its logarithm"],
)
def test_a_figure_that_no_run_has_ends_with_the_reason(done, tmp_path, words):
    """Runs of 1 s cannot have been settled for 2 s."""
    _, out = done
    code, said = run(*(word.format(out=out, tmp=tmp_path) for word in words))
    assert code == 78
    assert "no run has settling_s (of 96: 96 ok): a run has it only if" in said
    assert "for at least 2 s; these last 1 s" in said
    assert not (tmp_path / "a.png").exists()


def test_a_report_shows_the_figures_there_are_beside_one_that_no_run_has(done):
    _, out = done
    code, said = run("report", out, "--metric", "settling_s", "--metric", "rms_distance_mm")
    assert code == 0 and "no run has settling_s" in said
    assert "largest rms_distance_mm" in said and "largest settling_s" not in said


@pytest.mark.parametrize("package", ["pyarrow", "distributed"])
def test_without_its_packages_it_says_what_to_install(tmp_path, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    code, said = run(written(tmp_path), "--out", tmp_path / "out", "--workers", 1)
    assert code == 69 and "pip install 'pilotfish[sweep]'" in said
