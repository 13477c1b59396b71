"""The shared libraries: their names carry the version, they show what the headers declare, and others run on them."""

import os
import re
import subprocess
from pathlib import Path

import pytest

from build_tree import ROOT, one_at_a_time, run

pytestmark = pytest.mark.builds

BUILD = ROOT / "build" / "shared-library"
LIBRARIES = ["core", "fuzzy", "vision"]  # vision stands on core
VERSION = re.search(r"project\(pilotfish VERSION (\d+)\.(\d+)\.", (ROOT / "CMakeLists.txt").read_text()).groups()


@pytest.fixture(scope="session")
def prefix():
    """Where they are installed. Half a minute the first time without a compiler cache, nothing after that."""
    with one_at_a_time(BUILD):
        options = ["-DBUILD_SHARED_LIBS=ON", "-DPILOTFISH_COMPONENTS=fuzzy;vision", "-DCMAKE_BUILD_TYPE=Release"]
        run("cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", *options)
        run("cmake", "--build", BUILD)
        run("cmake", "--install", BUILD, "--prefix", BUILD / "prefix", "--component", "development")
    return BUILD / "prefix"


def library(prefix, name):
    (found,) = prefix.rglob(f"libpilotfish_{name}.so")
    return found


def exported(file):
    """(kind, mangled name) of what a program can link with; kinds as in nm(1)."""
    return [tuple(line.split()[-2:]) for line in run("nm", "-D", "--defined-only", file).splitlines()]


@pytest.mark.parametrize("name", LIBRARIES)
def test_before_1_0_the_name_of_a_library_carries_the_minor_version(prefix, name):
    said = run("readelf", "-d", library(prefix, name))
    assert f"Library soname: [libpilotfish_{name}.so.{'.'.join(VERSION)}]" in said
    assert library(prefix, name).resolve().name.startswith(f"libpilotfish_{name}.so.{'.'.join(VERSION)}.")


@pytest.mark.parametrize("name", LIBRARIES)
def test_a_library_shows_nothing_but_pilotfish(prefix, name):
    symbols = exported(library(prefix, name))
    assert len(symbols) > 5, "nothing is tested"
    # Itanium C++ ABI: functions and data of a namespace, its classes' tables and type names, guards of its statics.
    ours, of_std = (
        re.compile(rf"_Z(GV|T[VSIT])?Z*(N[KVRO]*)?({space})") for space in ("9pilotfish", "S[tabsiod]|9__gnu_cxx")
    )
    # The standard library's headers make themselves visible: a copy of what is used is in every C++ library, and weak.
    foreign = [name for kind, name in symbols if not ours.match(name) and not (kind in "WVu" and of_std.match(name))]
    assert foreign == []


def test_a_program_runs_on_two_of_them_and_catches_what_one_throws(prefix, tmp_path):
    (pkgconfig,) = prefix.rglob("pkgconfig")
    flags = subprocess.run(
        ["pkg-config", "--cflags", "--libs", "pilotfish-fuzzy", "pilotfish-vision"],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"PKG_CONFIG_PATH": str(pkgconfig)},
    ).stdout.split()
    source = Path(__file__).parent / "shared_consumer.cpp"
    rpath = f"-Wl,-rpath,{library(prefix, 'core').parent}"
    run("c++", "-std=c++17", source, *flags, rpath, "-o", tmp_path / "consumer")
    needed = run("readelf", "-d", tmp_path / "consumer")
    for name in ("fuzzy", "vision"):
        assert f"Shared library: [libpilotfish_{name}.so.{'.'.join(VERSION)}]" in needed
    # tag36h11 has 587 tags
    assert run(tmp_path / "consumer").split() == ["0.50", "587", "leader.family"]
