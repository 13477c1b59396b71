"""Programs are found where they can be, and the error says where they were looked for."""

import pytest

from pilotfish.errors import ExecutableNotFoundError
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable


def make_program(folder, name):
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / name
    file.write_text("#!/bin/sh\n")
    file.chmod(0o755)
    return file


def test_the_folder_that_the_environment_names_wins(tmp_path, monkeypatch):
    file = make_program(tmp_path / "mine", SIM)
    monkeypatch.setenv("PILOTFISH_BIN", str(tmp_path / "mine"))
    assert find_executable(SIM) == file


def test_a_named_folder_without_the_program_is_an_error_and_not_a_reason_to_look_elsewhere(tmp_path, monkeypatch):
    make_program(tmp_path / "other", COORDINATOR)
    monkeypatch.setenv("PATH", str(tmp_path / "other"))
    monkeypatch.setenv("PILOTFISH_BIN", str(tmp_path))
    with pytest.raises(ExecutableNotFoundError) as caught:
        find_executable(COORDINATOR)
    assert str(tmp_path) in str(caught.value)
    assert "cmake --build" in str(caught.value)
    assert "pip install" in str(caught.value)


def test_a_program_on_the_path_is_found_last(tmp_path, monkeypatch):
    monkeypatch.delenv("PILOTFISH_BIN", raising=False)
    file = make_program(tmp_path, "pilotfish-only-here")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert find_executable("pilotfish-only-here") == file


def test_a_file_that_cannot_be_executed_is_not_a_program(tmp_path, monkeypatch):
    make_program(tmp_path, SIM).chmod(0o644)
    monkeypatch.setenv("PILOTFISH_BIN", str(tmp_path))
    with pytest.raises(ExecutableNotFoundError):
        find_executable(SIM)


def test_the_programs_of_this_build_are_found_without_any_hint(monkeypatch):
    monkeypatch.delenv("PILOTFISH_BIN", raising=False)
    assert find_executable(SIM).name == SIM
    assert find_executable(COORDINATOR).parent == find_executable(SIM).parent
