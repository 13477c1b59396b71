"""The simulator's numbers on the command line."""

import subprocess

import pytest

from pilotfish import data
from pilotfish.harness.executables import SIM, find_executable

RANGES = {"--duration-s": "0 to 100000", "--wait-s": "0.01 to 100000", "--seed": "0 to 2147483647"}


@pytest.mark.parametrize(
    "value", ["abc", "", "10s", "1e", "nan", "inf", "-inf", "-1", "1e308", "1e309", "0x10", "9" * 400]
)
@pytest.mark.parametrize("option", RANGES)
def test_what_is_no_number_of_the_range_ends_with_64_and_says_the_range(option, value):
    done = subprocess.run(
        [find_executable(SIM), "--scenario", data.path("scenarios/line.yaml"), f"{option}={value}"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 64
    assert option in done.stderr
    if value:  # an empty one is refused by the parser
        assert f"'{value}' is not a number from {RANGES[option]}" in done.stderr
        assert len(done.stderr) < 300 + len(value)
