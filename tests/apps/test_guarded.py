"""A program that nothing else has stopped ends with 70 and one line, whatever is thrown; it never aborts."""

import subprocess
from pathlib import Path

import pytest

from build_tree import ROOT, run


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    built = tmp_path_factory.mktemp("guarded") / "program"
    run("c++", "-std=c++17", f"-I{ROOT / 'apps'}", Path(__file__).with_name("guarded_program.cpp"), "-o", built)
    return built


@pytest.mark.parametrize(
    ("thrown", "code", "says"),
    [
        ("nothing", 3, ""),
        ("exception", 70, "program: no more paper\n"),
        ("number", 70, "program: failed for an unknown reason\n"),
    ],
)
def test_what_nobody_has_caught_becomes_an_exit_code_and_a_line(program, thrown, code, says):
    done = subprocess.run([program, thrown], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (code, says)
