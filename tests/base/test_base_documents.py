"""What is written about the wheels' process is what it does."""

import re
import subprocess
from pathlib import Path

import pytest
from motor_controller import checksum
from wheels_process import CONFIG

from pilotfish import base
from pilotfish.harness.executables import BASE, find_executable

DOCS = Path(__file__).parents[2] / "docs"
PROTOCOL = (DOCS / "base-serial-protocol.md").read_text()


def run(*arguments):
    command = [str(find_executable(BASE)), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=30)


def test_every_example_line_of_the_protocol_has_its_checksum():
    examples = re.findall(r"`\$(PF[WE],[-0-9,]+)\*([0-9A-F]{2})`", PROTOCOL)
    assert len(examples) == 2
    for body, sum_ in examples:
        assert f"{checksum(body.encode()):02X}" == sum_


def test_the_example_of_wheel_speeds_is_the_line_that_is_sent():
    line = base.set_point_line(sequence=7, left_radps=-1.5, right_radps=2.25).decode().strip()
    assert f"`{line}`" in PROTOCOL


def test_the_example_of_encoders_is_read():
    example = re.search(r"\$PFE,[-0-9,]+\*[0-9A-F]{2}", PROTOCOL)
    (line,) = base.ControllerParser().feed(example[0].encode() + b"\n")
    assert (line.sequence, line.time_ms, line.left_ticks, line.right_ticks, line.faults) == (7, 52100, -311, 466, 0)


def test_the_table_of_the_configuration_is_the_programs_own():
    done = run("--describe-config")
    assert done.returncode == 0
    assert done.stdout == (DOCS / "base-configuration.md").read_text()


def test_the_shipped_configuration_loads():
    file = base.load_base(CONFIG)
    assert (file.name, file.device) == ("robot1", "")
    assert file.base.commands.max_command_age_s == 0.095


def test_help_teaches_with_examples():
    done = run("--help")
    assert done.returncode == 0
    assert "pilotfish-base --config base.yaml --driver serial:/dev/ttyUSB0" in done.stdout


@pytest.mark.parametrize("arguments", [(), ("--config",), ("--config", CONFIG, "--fast")])
def test_a_wrong_command_line_ends_with_64(arguments):
    assert run(*arguments).returncode == 64


BROKEN = [
    ("name: robot1", "name: robot 1", "name: 'robot 1' is not a name"),
    ("driver: dry_run", "driver: motors", "driver: 'motors' is not a driver; choose dry_run, simulator or serial:"),
    ("driver: dry_run", "driver: serial:ttyUSB0", "driver: 'serial:ttyUSB0' is not a driver"),
    ("rate_hz: 50", "rate_hz: 5", r"rate_hz: 5 is outside \[30, 200\]"),
    ("wheel_radius_m: 0.05", "wheel_radius_m: 0", r"wheels\.wheel_radius_m: 0 is outside"),
    ("track_width_m: 0.30", "track_width_m: .nan", r"wheels\.track_width_m: nan is outside"),
    (
        "max_command_age_s: 0.095",
        "max_command_age_s: 0.11",
        r"commands\.max_command_age_s: 0.11 is outside \[0.02, 0.1\]",
    ),
    ("baud: 115200", "baud: 115201", r"serial\.baud: 115201 is not a line's speed"),
    ("brake_mps2: 3.0", "brakes_mps2: 3.0", r"limits\.brakes_mps2"),
    ("rate_hz: 50", "key_file: nowhere", r"key_file"),
]


@pytest.mark.parametrize(("old", "new", "message"), BROKEN)
def test_a_bad_configuration_ends_with_78_and_the_keys_name(tmp_path, old, new, message):
    text = CONFIG.read_text()
    assert old in text
    file = tmp_path / "base.yaml"
    file.write_text(text.replace(old, new, 1))
    done = run("--config", file, "--lcm-url", "memq://")
    assert done.returncode == 78
    assert re.search(message, done.stderr), done.stderr


def test_real_wheels_need_their_size(tmp_path):
    file = tmp_path / "base.yaml"
    file.write_text("name: robot1\ndriver: serial:/dev/ttyUSB0\n")
    done = run("--config", file)
    assert done.returncode == 78
    assert "wheels: is missing" in done.stderr


@pytest.mark.parametrize(
    ("device", "words"),
    [
        ("/dev/nothing", "cannot open the serial line /dev/nothing: No such file or directory; "),
        ("/dev/null", "is not a serial line"),
    ],
)
def test_a_line_that_cannot_be_opened_ends_with_69(device, words):
    done = run("--config", CONFIG, "--driver", f"serial:{device}")
    assert done.returncode == 69
    assert words in done.stderr
