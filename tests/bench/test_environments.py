"""scripts/bench lists what there is and runs what it is asked for; its environments are pinned to the last package."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from bench import runner

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
INPUTS = [ROOT / "requirements-dev.in", *sorted((ROOT / "bench" / "requirements").glob("*.in"))]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
EXTRAS = PROJECT["project"]["optional-dependencies"]
PYTHONS, MACHINES = ("3.10", "3.11", "3.12"), ("x86_64", "aarch64")


def requirements(file: Path) -> list[Requirement]:
    lines = [line.partition("#")[0].strip() for line in file.read_text().splitlines()]
    return [Requirement(line) for line in lines if line]


def asked(file: Path) -> list[Requirement]:
    """What scripts/lock is to pin: the file, and its share of pyproject.toml."""
    texts = list(PROJECT["project"]["dependencies"])
    if file.name == "requirements-dev.in":
        texts += PROJECT["build-system"]["requires"]
        texts += [text for name, extra in EXTRAS.items() if name != "rerun" for text in extra]  # as scripts/lock
    return requirements(file) + [Requirement(text) for text in texts]


def place(python: str, machine: str) -> dict[str, str]:
    """What markers are evaluated for."""
    version = {"python_version": python, "python_full_version": f"{python}.9", "platform_machine": machine}
    return version | {"sys_platform": "linux", "platform_system": "Linux", "platform_python_implementation": "CPython"}


def installed(lock: Path, python: str, machine: str) -> dict[str, str]:
    """Name to version, for that Python on that processor."""
    here = [each for each in requirements(lock) if each.marker is None or each.marker.evaluate(place(python, machine))]
    versions = {canonicalize_name(each.name): next(iter(each.specifier)).version for each in here}
    assert len(versions) == len(here), "two versions of one package"
    return versions


def bench(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([ROOT / "scripts" / "bench", *words], capture_output=True, text=True, timeout=60)


# --- the command -------------------------------------------------------------------------------------------------


def test_every_benchmark_is_listed_in_one_line_with_what_it_measures_and_how_long_it_takes():
    listed = bench().stdout.split("\n\n")[0].splitlines()
    folders = sorted(file.parent.name for file in ROOT.glob("bench/*/__main__.py"))
    assert [line.split()[0] for line in listed] == folders
    assert len(folders) >= 8
    assert max(map(len, listed)) <= 150
    for each in runner.benchmarks().values():
        assert each.what
        assert "minute" in each.takes or "hour" in each.takes, f"{each.name}: say how long behind 'Takes:'"


def test_every_benchmark_has_a_chapter_in_the_readme():
    text = (ROOT / "bench" / "README.md").read_text()
    assert [name for name in runner.benchmarks() if f"\n## `bench/{name}`" not in text] == []


def test_its_help_shows_examples_and_an_unknown_name_is_refused_with_those_there_are():
    help_ = bench("--help")
    assert help_.returncode == 0
    assert "scripts/bench fuzzy vision -- --quick" in help_.stdout
    wrong = bench("fuzy")
    assert wrong.returncode == 2
    assert "fuzy" in wrong.stderr and "fuzzy" in wrong.stderr


def test_what_is_behind_the_dashes_goes_to_each_benchmark_and_one_that_fails_shows(monkeypatch, capsys):
    ran = []

    def run(benchmark, arguments):
        ran.append((benchmark.name, arguments))
        return int(benchmark.name == "soak")

    monkeypatch.setattr(runner, "run", run)
    monkeypatch.setattr(runner, "PYTHON", Path(sys.executable))
    assert runner.main(["--no-build", "soak", "fuzzy", "--", "--help", "--", "x"]) == 1
    assert ran == [("soak", ["--help", "--", "x"]), ("fuzzy", ["--help", "--", "x"])]
    assert "soak: ended with 1" in capsys.readouterr().out
    ran.clear()
    assert runner.main(["--no-build", "all"]) == 1
    assert [name for name, _ in ran] == list(runner.benchmarks())


# --- environments ------------------------------------------------------------------------------------------------


def test_an_environment_is_installed_again_only_when_its_lock_file_changes(tmp_path, monkeypatch):
    lock, folder, commands = tmp_path / "lock.txt", tmp_path / "environment", []

    def run(command, check):
        assert check
        commands.append("venv" if "venv" in command else "install")
        if "venv" in command:
            (folder / "bin").mkdir(parents=True)
            (folder / "bin" / "python").touch()

    monkeypatch.setattr(runner.subprocess, "run", run)
    lock.write_text("numpy==1.26.4\n")
    for _ in range(2):
        runner.make_environment(lock, folder, Path("python3"))
    assert commands == ["venv", "install"]
    lock.write_text("numpy==2.4.6\n")
    for _ in range(2):
        runner.make_environment(lock, folder, Path("python3"))
    assert commands == ["venv", "install", "install"]


def test_an_installation_that_fails_is_tried_again(tmp_path, monkeypatch):
    lock, folder = tmp_path / "lock.txt", tmp_path / "environment"
    lock.write_text("numpy==1.26.4\n")
    (folder / "bin").mkdir(parents=True)
    (folder / "bin" / "python").touch()

    def run(command, check):
        raise subprocess.CalledProcessError(1, command)

    monkeypatch.setattr(runner.subprocess, "run", run)
    with pytest.raises(subprocess.CalledProcessError):
        runner.make_environment(lock, folder, Path("python3"))
    assert not runner.up_to_date(lock, folder)


# --- lock files --------------------------------------------------------------------------------------------------


def test_every_lock_file_of_a_benchmark_belongs_to_one():
    folder = ROOT / "bench" / "requirements"
    names = {file.stem for file in folder.iterdir()}
    assert names <= set(runner.benchmarks())
    assert {file.name for file in folder.iterdir()} == {f"{name}.{end}" for name in names for end in ("in", "txt")}


@pytest.mark.parametrize("file", INPUTS, ids=lambda file: file.stem)
def test_every_package_is_pinned_to_one_version_and_no_index_is_named(file):
    lock = file.with_suffix(".txt")
    for each in requirements(lock):
        (pin,) = each.specifier
        assert pin.operator == "==" and "*" not in pin.version, each
        assert each.url is None
    for line in lock.read_text().splitlines():
        assert not line.startswith("-")
        assert "://" not in line


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize("python", PYTHONS)
@pytest.mark.parametrize("file", INPUTS, ids=lambda file: file.stem)
def test_a_lock_file_has_what_is_asked_for(file, python, machine):
    versions = installed(file.with_suffix(".txt"), python, machine)
    for each in asked(file):
        if each.marker is not None and not each.marker.evaluate(place(python, machine)):
            continue  # not on this processor
        name = canonicalize_name(each.name)
        assert name in versions, f"{each} is not pinned: run scripts/lock"
        assert each.specifier.contains(versions[name]), f"{each}, but {versions[name]} is pinned: run scripts/lock"
