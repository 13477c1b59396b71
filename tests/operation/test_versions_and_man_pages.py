"""--version of every program, and man pages that hold what --help says."""

import re
import subprocess
from pathlib import Path

import pytest

from pilotfish import __version__
from pilotfish.harness.executables import COORDINATOR, find_executable

ROOT = Path(__file__).parents[2]
MAN = ROOT / "packaging" / "man"
APPS = find_executable(COORDINATOR).parent
PROGRAMS = sorted(file.name for file in APPS.glob("pilotfish-*") if file.is_file())
OPTION = re.compile(r"(?<![\w-])--?[a-z][a-z0-9-]*")


def said_by(program, option):
    return subprocess.run([APPS / program, option], capture_output=True, text=True, timeout=60, check=True).stdout


def test_there_are_programs_to_look_at():
    assert {"pilotfish-coordinator", "pilotfish-sim", "pilotfish-spy"} <= set(PROGRAMS)


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_program_says_its_name_and_the_projects_version(program):
    assert said_by(program, "--version") == f"{program} {__version__}\n"


def page_of(program, folder):
    page = folder / f"{program}.1"
    command = [MAN / "make_page", "help2man", APPS / program, page, MAN / "common.h2m", MAN / f"{program}.h2m"]
    subprocess.run(command, check=True, timeout=60, capture_output=True)
    return page.read_text().replace(r"\-", "-")


def options_listed(help_text):
    """What stands in front of an option's description: `-h,--help`, `--scenario TEXT REQUIRED`."""
    lines = [line for line in help_text.splitlines() if re.match(r" +-", line)]
    return {option for line in lines for option in OPTION.findall(re.split(r"\s{2,}", line.strip())[0])}


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_man_page_has_every_option_the_exit_codes_the_files_and_examples(program, tmp_path):
    page = page_of(program, tmp_path)
    options = options_listed(said_by(program, "--help"))
    assert len(options) >= 3
    missing = options - set(OPTION.findall(re.sub(r"\\f[BIRP]", "", page)))
    assert missing == set()
    headings = re.findall(r'^\.SH "?([A-Z ]+)', page, flags=re.MULTILINE)
    assert {"NAME", "SYNOPSIS", "DESCRIPTION", "EXIT STATUS", "FILES", "EXAMPLES", "SEE ALSO"} <= set(headings)
    for code in ("0", "64", "69", "70", "78"):  # apps/exit_codes.hpp
        assert f".B {code}\n" in page


@pytest.mark.not_sanitized("groff does not run with a sanitizer loaded in front of it")
@pytest.mark.parametrize("program", PROGRAMS)
def test_a_man_page_can_be_read(program, tmp_path):
    """groff says nothing about it, not even a warning."""
    page_of(program, tmp_path)
    command = ["groff", "-man", "-Tutf8", "-ww", "-z", tmp_path / f"{program}.1"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    except FileNotFoundError:
        pytest.skip("no groff")
    assert (done.returncode, done.stderr) == (0, "")
