"""Man pages of `pilotfish` and its commands: those in the repository are what the command line says of itself."""

import inspect
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pilotfish import errors
from pilotfish.cli import app, man_pages

ROOT = Path(__file__).parents[2]
STORED = ROOT / "packaging" / "man" / "pilotfish"
PAGES = man_pages.pages()
RENEW = "run: python -m pilotfish.cli.man_pages packaging/man/pilotfish"


def test_the_pages_in_the_repository_are_those_of_this_command_line():
    stored = {file.name: file.read_text() for file in STORED.glob("*")}
    assert sorted(stored) == sorted(PAGES), RENEW
    differing = [name for name in PAGES if stored[name] != PAGES[name]]
    assert differing == [], RENEW


def commands(name):
    """The words of the command that a page is of; a command's own name may have a hyphen."""
    words = re.search(r"^\.B (.*)$", PAGES[name], re.MULTILINE)[1].replace("\\-", "-").split()
    assert "-".join(words) == name.removesuffix(".1")
    return words[1:]


@pytest.mark.parametrize("name", sorted(PAGES))
def test_a_page_has_every_option_of_the_help_and_the_sections_people_look_for(name):
    said = CliRunner().invoke(app, [*commands(name), "--help"], env={"COLUMNS": "200"}).output
    listed = {
        option
        for line in re.sub(r"\x1b\[[0-9;]*m", "", said).splitlines()
        if line.startswith("│ ")
        for option in re.findall(r"(?<![\w-])--?[a-z][\w-]*", re.match(r"│ [*]? *((-[-\w]+ *)+)?", line)[0])
    }
    assert "--help" in listed
    page = PAGES[name].replace("\\-", "-")
    assert listed <= set(re.findall(r"(?<![\w-])--?[a-z][\w-]*", re.sub(r"\\f[BIR]", " ", page)))
    headings = re.findall(r"^\.SH (.*)$", page, re.MULTILINE)
    assert {"NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "ENVIRONMENT", "SEE ALSO"} <= set(headings)
    assert ("COMMANDS" in headings) == ("COMMAND [ARGS]" in page)
    words = " ".join(commands(name))
    assert "COMMANDS" in headings or re.search(rf"^pilotfish {words}( |$)", page, re.MULTILINE), "no example"


def test_every_exit_code_that_an_error_has_is_explained():
    kinds = [kind for _, kind in inspect.getmembers(errors, inspect.isclass)]
    codes = {kind.exit_code for kind in kinds if issubclass(kind, errors.PilotfishError)}
    assert codes <= set(man_pages.EXIT_STATUS)


def test_the_exit_codes_are_those_of_the_guide():
    guide = (
        (ROOT / "docs/operating-guide.md").read_text().partition("Of `pilotfish` (Python):")[2].partition("\n## ")[0]
    )
    codes = {int(code) for row in re.findall(r"^\| ([\d, ]+) \|", guide, re.MULTILINE) for code in row.split(",")}
    assert codes == set(man_pages.EXIT_STATUS)


@pytest.mark.not_sanitized("groff does not run with a sanitizer loaded in front of it")
def test_groff_has_no_complaint_about_any_page(tmp_path):
    if shutil.which("groff") is None:
        pytest.skip("no groff")
    for name, text in PAGES.items():
        (tmp_path / name).write_text(text)
    command = ["groff", "-man", "-Tutf8", "-ww", "-z", *(tmp_path / name for name in PAGES)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.not_sanitized("groff does not run with a sanitizer loaded in front of it")
def test_what_has_a_meaning_to_groff_is_printed_as_it_is(tmp_path):
    if shutil.which("groff") is None:
        pytest.skip("no groff")
    awkward = [".SH no heading", "'quoted", 'a \\ "b" --option \\fBbold', "1 \\- 2"]
    lines = ['.TH "X" 1', ".SH NAME", ".nf", *map(man_pages._escaped, awkward), ".fi"]
    (tmp_path / "x.1").write_text("\n".join(lines) + "\n")
    command = ["groff", "-man", "-Tascii", "-P-cbou", tmp_path / "x.1"]
    shown = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
    for line in awkward:
        assert line in [each.strip() for each in shown.splitlines()], shown


def test_the_page_of_a_command_that_is_no_more_goes(tmp_path):
    (tmp_path / "pilotfish-old.1").write_text("of old")
    (tmp_path / "other.1").write_text("somebody's")
    man_pages.write(tmp_path)
    assert not (tmp_path / "pilotfish-old.1").exists()
    assert (tmp_path / "other.1").read_text() == "somebody's"
