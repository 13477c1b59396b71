"""pilotfish-sim plays what is shipped by its name, from any folder."""

import subprocess

import pytest

from pilotfish import data as shipped
from pilotfish.harness.executables import SIM, find_executable
from pilotfish.harness.ports import private_lcm_url


def simulate(folder, *arguments, **environment):
    command = [find_executable(SIM), "--lcm-url", private_lcm_url(), "--wait-s", "0.05", *arguments]
    return subprocess.run(
        [str(word) for word in command], cwd=folder, env=environment or None, capture_output=True, text=True, timeout=30
    )


@pytest.mark.parametrize("name", ["line", "star"])
def test_a_shipped_scenario_is_played_by_its_name(tmp_path, name):
    done = simulate(tmp_path, "--scenario", name)
    assert f"scenario {name}:" in done.stderr
    assert done.returncode == 70  # no coordinator answers: it is played


def test_a_file_of_that_name_comes_first(tmp_path):
    text = shipped.path("scenarios/square.yaml").read_text().replace("../", f"{shipped.root()}/")
    (tmp_path / "line").write_text(text)
    assert "scenario square:" in simulate(tmp_path, "--scenario", "line").stderr


def test_another_folder_of_data_can_be_given(tmp_path):
    (tmp_path / "scenarios").mkdir()
    text = shipped.path("scenarios/square.yaml").read_text().replace("../", f"{shipped.root()}/")
    (tmp_path / "scenarios" / "line.yaml").write_text(text)
    assert "scenario square:" in simulate(tmp_path, "--scenario", "line", PILOTFISH_DATA=str(tmp_path)).stderr


def test_an_unknown_name_lists_the_shipped_ones(tmp_path):
    done = simulate(tmp_path, "--scenario", "lime")
    assert done.returncode == 78
    assert "--scenario: 'lime' is neither a file nor a shipped scenario; shipped are chain, circle" in done.stderr


def test_a_missing_file_is_named_as_before(tmp_path):
    done = simulate(tmp_path, "--scenario", "there/is/none.yaml")
    assert done.returncode == 78
    assert "none.yaml" in done.stderr
