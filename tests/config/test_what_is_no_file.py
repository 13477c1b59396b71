"""What is read from disk is a regular file of bounded size. Everything else is refused with the key that named it,
without waiting for a pipe and without reading a device to its end."""

import os
import shutil
import socket
import subprocess
from pathlib import Path

import pytest

from pilotfish import coordinator, core, fuzzy, sim
from pilotfish import data as shipped
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable

DATA = shipped.path(".")
AT_MOST_S = 30.0


def directory(path):
    path.mkdir()


def pipe(path):
    os.mkfifo(path)


def unix_socket(path):
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))


def endless_device(path):
    path.symlink_to("/dev/zero")


def circle_of_links(path):
    path.symlink_to(path.name)


def too_large(path):
    with path.open("wb") as stream:
        stream.truncate(100_000_000)


def nothing(path):
    pass


KINDS = {
    directory: "is a directory, not a file",
    pipe: "is a pipe, not a file",
    unix_socket: "is a socket, not a file",
    endless_device: "is a device, not a file",
    circle_of_links: "Too many levels of symbolic links",
    too_large: "is too large; at most 262144 bytes are read",
    nothing: "No such file or directory",
}


@pytest.fixture(params=KINDS, ids=lambda make: make.__name__)
def no_file(request, tmp_path):
    """A path where no file can be read, and what must be said about it."""
    path = tmp_path / "wanted"
    request.param(path)
    return path, f"{path}.*{KINDS[request.param]}|{path}: {KINDS[request.param]}"


@pytest.fixture
def folder(tmp_path):
    for name in ("config", "fuzzy", "calibrations", "leaders", "scenarios"):
        shutil.copytree(DATA / name, tmp_path / name)
    return tmp_path


def names_it_in(folder, key, path):
    """line.yaml, with ``path`` where ``key`` stands."""
    config = folder / "config" / "line.yaml"
    lines = [
        f"{line.split(key)[0]}{key}: {path}" if line.strip().startswith(f"{key}:") else line
        for line in config.read_text().splitlines()
    ]
    if key == "tuning":
        lines.append(f"tuning: {path}")
    config.write_text("\n".join(lines) + "\n")
    return config


@pytest.mark.parametrize(
    ("load", "key"),
    [
        (coordinator.load_coordinator, "file"),
        (coordinator.load_calibration, "calibration"),
        (coordinator.load_leader_body, "file"),
        (fuzzy.load_controller, "file"),
        (sim.load_scenario, "file"),
    ],
    ids=["configuration", "calibration", "leader", "fuzzy", "scenario"],
)
@pytest.mark.fault("not_a_file")
def test_what_is_no_file_is_refused_by_every_reader(no_file, load, key):
    path, says = no_file
    with pytest.raises(ValueError, match=f"^{key}: ({says}|cannot read {says})"):
        load(path)


@pytest.mark.parametrize("key", ["calibration", "leader", "fuzzy", "tuning"])
def test_what_is_no_file_is_refused_with_the_key_that_names_it(no_file, folder, key):
    path, says = no_file
    with pytest.raises(ValueError, match=rf"^(camera\.)?{key}: ({says}|cannot read {says})"):
        coordinator.load_coordinator(names_it_in(folder, key, path))


@pytest.mark.parametrize(
    ("program", "option"), [(COORDINATOR, "--config"), (SIM, "--scenario")], ids=["coordinator", "sim"]
)
@pytest.mark.fault("not_a_file")
def test_a_program_that_is_given_no_file_ends_with_78_and_the_key(no_file, program, option):
    path, _ = no_file
    done = subprocess.run(
        [find_executable(program), option, path, "--lcm-url", "memq://"],
        capture_output=True,
        text=True,
        timeout=AT_MOST_S,
        check=False,
    )
    assert done.returncode == 78
    assert f"file: {path}" in done.stderr or f"file: cannot read {path}" in done.stderr


def test_a_scenario_s_own_files_are_refused_with_their_place(no_file, folder):
    path, says = no_file
    scenario = folder / "scenarios" / "line.yaml"
    text = scenario.read_text()
    assert "calibration: " in text
    scenario.write_text(
        "\n".join(
            f"{line.split('calibration:')[0]}calibration: {path}" if "calibration:" in line else line
            for line in text.splitlines()
        )
    )
    with pytest.raises(ValueError, match=rf"^robots\[\d\]\.camera\.calibration: ({says}|cannot read {says})"):
        sim.load_scenario(scenario)


def test_a_file_of_the_largest_size_is_read_and_one_byte_more_is_not(tmp_path):
    file = tmp_path / "file"
    for size in (0, 1, 4095, 4096):
        file.write_bytes(b"x" * size)
        assert core.read_file(file, 4096) == b"x" * size
    file.write_bytes(b"x" * 4097)
    with pytest.raises(ValueError, match="too large; at most 4096 bytes"):
        core.read_file(file, 4096)


def test_files_that_do_not_say_their_size_are_read_within_the_bound():
    """The files of /proc say 0 bytes."""
    status = Path("/proc/self/status")
    assert status.stat().st_size == 0
    assert core.read_file(status, 1 << 20).startswith(b"Name:")
    with pytest.raises(ValueError, match="too large"):
        core.read_file(status, 10)


@pytest.mark.parametrize(
    "bytes_",
    [b"\xff", b"\xc0\xaf", b"\xe2\x82", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"\x80", b"\xf8\x88\x80\x80\x80"],
    ids=["no lead byte", "not shortest", "cut off", "surrogate", "beyond U+10FFFF", "no beginning", "five bytes"],
)
def test_what_is_not_utf8_is_refused_with_the_byte_that_is_not(tmp_path, bytes_):
    with pytest.raises(UnicodeDecodeError):
        bytes_.decode("utf-8")  # Python agrees
    (tmp_path / "latin.yaml").write_bytes("name: fische \u00e4 \u20ac \U0001f41f ".encode() + bytes_)
    with pytest.raises(ValueError, match=r"^file: .*latin\.yaml is not a text in UTF-8: byte 25 is none"):
        coordinator.load_coordinator(tmp_path / "latin.yaml")


NESTED = {
    "lists": "[" * 100_000,
    "mappings": "{a: " * 50_000,
    "lists of lists": "- " * 100_000,
    "questions": "? " * 100_000,
    "indented": "\n".join(" " * depth + "a:" for depth in range(700)),
    # Nine aliases of nine aliases ...: 9^20 elements, if anyone followed them.
    "aliases": "a0: &a0 [x]\n" + "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 21)),
    "documents": " ,\n\n%i",  # to yaml-cpp 0.7 one empty document after the other
    "itself": "robots: &a [*a]\nname: &b {name: *b}\nE: *b\ntags: *a",
}


@pytest.mark.parametrize("text", NESTED.values(), ids=NESTED)
@pytest.mark.parametrize(
    "load",
    [
        coordinator.load_coordinator,
        coordinator.load_calibration,
        coordinator.load_leader_body,
        fuzzy.load_controller,
        sim.load_scenario,
    ],
    ids=["configuration", "calibration", "leader", "fuzzy", "scenario"],
)
def test_yaml_without_bottom_is_refused(tmp_path, text, load):
    (tmp_path / "deep.yaml").write_text(text)
    with pytest.raises(ValueError, match=r"^[\w.\[\]]+: "):
        load(tmp_path / "deep.yaml")


@pytest.mark.parametrize(
    ("load", "key", "text"),
    [
        (coordinator.load_coordinator, "name", "name: ~"),
        (coordinator.load_leader_body, "family", "name: a\nfamily:\n"),
        (coordinator.load_leader_body, "tags", "name: a\nfamily: tag36h11\ntags:\n"),
    ],
)
def test_a_key_without_a_value_is_said_to_have_none(tmp_path, load, key, text):
    (tmp_path / "empty.yaml").write_text(text)
    with pytest.raises(ValueError, match=rf"^{key}: nothing is not a "):
        load(tmp_path / "empty.yaml")
