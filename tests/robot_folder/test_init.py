"""``pilotfish init``: a folder in which the real programs run, from anywhere; and that never overwrites."""

import json
import re
import subprocess
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from pilotfish import coordinator, data
from pilotfish.cli import app
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, COORDINATOR, find_executable
from pilotfish.harness.scenario import Scenario
from pilotfish.harness.sequences import render_sequence
from pilotfish.robot_folder import Options, create, planned, units

ROOT = Path(__file__).parents[2]
PACKAGED = ROOT / "packaging" / "systemd"


def run(*arguments):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    return result.exit_code, re.sub(r"[\s│]+", " ", result.output)


@pytest.fixture
def folder(tmp_path):
    create("robot7", tmp_path / "a robot", Options(user="daemon"))
    return tmp_path / "a robot"


# --- what is in it ----------------------------------------------------------------------------------------------------
def test_the_folder_has_everything_and_every_file_is_named(tmp_path):
    code, said = run("init", "robot7", "--dir", tmp_path / "here")
    assert code == 0, said
    made = {str(file.relative_to(tmp_path / "here")) for file in (tmp_path / "here").rglob("*") if file.is_file()}
    assert made == {
        *("robot7.yaml", "calibration.yaml", "leader.yaml", "fuzzy.yaml", "base.yaml", "wheel_driver.py", "README.md"),
        *("systemd/pilotfish-robot7-coordinator.service", "systemd/pilotfish-robot7-base.service"),
        "systemd/pilotfish-lcm-route.service",
    }
    for file in made:
        assert f"/here/{file}" in said.replace("\n", "")
    readme = (tmp_path / "here/README.md").read_text()
    for file in made - {"README.md"}:
        assert file in readme or file.startswith("systemd/")
    assert [file.name for file in tmp_path.iterdir()] == ["here"]  # nothing is left beside it


def test_a_new_robot_stands_still_and_looks_through_its_first_camera(folder):
    loaded = coordinator.load_coordinator(str(folder / "robot7.yaml"))
    assert (loaded.name, loaded.source) == ("robot7", "camera:0")
    assert not loaded.coordinator.setpoint.run


def test_apart_from_name_source_paths_and_standing_still_the_configuration_is_the_shipped_one(folder):
    own, shipped = (
        yaml.safe_load(f.read_text()) for f in (folder / "robot7.yaml", data.path("config/coordinator.yaml"))
    )
    own["camera"]["calibration"], shipped["camera"]["calibration"] = "", ""
    assert own["setpoint"].pop("run") is False
    changed = {key for key in shipped if own[key] != shipped[key]}
    assert changed == {"name", "source", "leader", "fuzzy"}
    assert set(own) == set(shipped)


def test_what_must_be_replaced_says_so_in_its_first_lines(folder):
    for file in ("calibration.yaml", "leader.yaml"):
        assert "TO BE REPLACED" in "".join((folder / file).read_text().splitlines()[:3])


def test_own_calibration_and_leader_are_copied(tmp_path):
    chosen = Options(
        "lcm:EYE", calibration=data.path("calibrations/visp_640x480.xml"), leader=data.path("leaders/single_tag.yaml")
    )
    create("r", tmp_path / "r", chosen)
    loaded = coordinator.load_coordinator(str(tmp_path / "r/r.yaml"))
    assert loaded.source == "lcm:EYE"
    assert [tag.id for tag in loaded.coordinator.leader.tags] == [0]
    assert (tmp_path / "r/calibration.xml").read_bytes() == data.path("calibrations/visp_640x480.xml").read_bytes()


# --- it runs ----------------------------------------------------------------------------------------------------------
def test_the_coordinator_runs_in_it_on_rendered_pictures_from_anywhere(folder, tmp_path):
    """The line scenario's pictures have the camera and leader that the folder begins with: the distances are the true
    ones, 2.44 m at first. It stands still, so every command is zero."""
    pictures, elsewhere = tmp_path / "pictures", tmp_path / "elsewhere"
    elsewhere.mkdir()
    assert render_sequence(Scenario.load(data.path("scenarios/line.yaml")), pictures, frames=3) == 3
    moved = folder.rename(tmp_path / "moved")
    words = [find_executable(COORDINATOR), "--config", moved / "robot7.yaml", "--source", f"images:{pictures}"]
    done = subprocess.run(
        [*words, "--lcm-url", "memq://", "--json"], cwd=elsewhere, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    frames = [json.loads(line) for line in done.stdout.splitlines()]
    assert [frame["status"] for frame in frames] == 3 * ["stopped"]
    assert frames[0]["distance_m"] == pytest.approx(2.44, abs=0.01)


def test_the_base_starts_with_its_configuration(folder, tmp_path):
    words = [find_executable(BASE), "--config", folder / "base.yaml", "--lcm-url", "memq://"]
    with Child(words, tmp_path, "base") as base:
        base.wait_until(lambda: "wheels of robot7: dry run" in base.stderr() + base.stdout(), 20, "being ready")


# --- units ------------------------------------------------------------------------------------------------------------
def lines(text):
    return [line for line in text.splitlines() if line and not line.startswith("#")]


@pytest.mark.parametrize("which", ["coordinator", "base"])
def test_a_unit_is_the_package_s_but_for_names_paths_and_user(folder, which):
    packaged = lines((PACKAGED / f"pilotfish-{which}@.service").read_text())
    own = lines((folder / f"systemd/pilotfish-robot7-{which}.service").read_text())
    assert len(own) == len(packaged)
    different = {line.partition("=")[0] for line, other in zip(own, packaged, strict=True) if line != other}
    allowed = {"Description", "Documentation", "After", "ExecStart", "User", "Group", "StateDirectory", "ProtectHome"}
    assert {"ExecStart", "User"} <= different <= allowed


def test_the_route_s_unit_is_the_package_s(folder):
    packaged = lines((PACKAGED / "pilotfish-lcm-route.service").read_text())
    own = lines((folder / "systemd/pilotfish-lcm-route.service").read_text())
    assert [line for line in own if not line.startswith("Documentation=")] == [
        line for line in packaged if not line.startswith("Documentation=")
    ]


def test_systemd_understands_every_line(folder):
    """The folder's name has a space in it, and the programs are there: nothing at all may be said."""
    files = sorted((folder / "systemd").glob("*.service"))
    done = subprocess.run(["systemd-analyze", "verify", *files], capture_output=True, text=True, timeout=60)
    assert [line for line in done.stderr.splitlines() if "pilotfish" in line and "/sbin/ip " not in line] == []


@pytest.mark.parametrize(("place", "protected"), [("/srv/robots", "yes"), ("/home/me/robots", "read-only")])
def test_a_folder_in_a_home_is_readable_for_its_service_and_homes_are_hidden_otherwise(place, protected):
    service = units.Service("r", Path(place), Path("/usr/bin/p"), Path(place, "r.yaml"), "me", "me")
    assert f"ProtectHome={protected}" in units.coordinator_unit(service)


def test_words_with_a_meaning_to_systemd_are_escaped():
    assert units.quoted(Path("/srv/50% of it")) == r"/srv/50%%\x20of\x20it"
    assert units.quoted(Path("/srv/$HOME \\")) == r"/srv/$$HOME\x20\\"
    assert units.document_url(Path("/srv/größe 1")) == "file:/srv/gr%%C3%%B6%%C3%%9Fe%%201"


STRANGE = [
    "it's",
    'say "x"',
    "größe 雪",
    "do$HOME",
    "${x}",
    "50%h",
    "back\\slash",
    "semi; colon",
    "-dash",
    "#[*]?{}&|<>",
]


def test_systemd_finds_a_program_and_a_page_at_a_strange_place(tmp_path):
    """`verify` says of a program that it is not there or cannot be executed, and of a page that it is no URL."""
    files = []
    for k, name in enumerate(STRANGE):
        program = tmp_path / name / "program"
        program.parent.mkdir()
        program.write_text("#!/bin/sh\n")
        program.chmod(0o755)
        service = units.Service("r", program.parent, program, program.parent / "r.yaml", "daemon", "daemon")
        files.append(tmp_path / f"pilotfish-r{k}.service")
        files[-1].write_text(units.base_unit(service))
    files.append(tmp_path / "pilotfish-nowhere.service")  # and of one that is not there it does say so
    files[-1].write_text(files[STRANGE.index("do$HOME")].read_text().replace("/program", "/nowhere"))
    done = subprocess.run(["systemd-analyze", "verify", *files], capture_output=True, text=True, timeout=60)
    said = [line for line in done.stderr.splitlines() if "pilotfish-" in line and "Command 'man " not in line]
    assert [line for line in said if "nowhere" not in line] == []
    assert any("nowhere" in line and "not executable" in line for line in said)


@pytest.mark.parametrize("name", ["new\nline", "tab\there", "bell\x07", "latin1\udce9"])
def test_a_folder_that_no_unit_can_name_is_refused_and_nothing_is_left(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    code, said = run("init", "r", "--dir", name)
    assert code == 64, said
    assert "systemd unit" in said
    assert list(tmp_path.iterdir()) == []


def test_the_services_run_as_who_was_asked_for(tmp_path):
    """Every system has the user daemon."""
    unit = planned("r", tmp_path, Options(user="daemon"))["systemd/pilotfish-r-base.service"]
    assert "User=daemon\n" in unit
    assert "@" not in re.sub(r"#.*|SystemCallFilter=.*", "", unit)


# --- what is refused --------------------------------------------------------------------------------------------------
def test_nothing_is_ever_overwritten(folder, tmp_path):
    before = (folder / "robot7.yaml").read_bytes()
    code, said = run("init", "robot7", "--dir", folder)
    assert code == 74
    assert "is there already" in said
    assert (folder / "robot7.yaml").read_bytes() == before
    (tmp_path / "file").write_text("x")
    assert run("init", "robot7", "--dir", tmp_path / "file")[0] == 64
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    assert run("init", "robot7", "--dir", tmp_path / "link")[0] in (64, 74)


def test_an_empty_folder_is_used(tmp_path):
    (tmp_path / "empty").mkdir()
    assert run("init", "robot7", "--dir", tmp_path / "empty")[0] == 0
    assert (tmp_path / "empty/robot7.yaml").is_file()


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["a b"], 64, "1 to 32 letters"),
        ([""], 64, "1 to 32 letters"),
        (["../x"], 64, "1 to 32 letters"),
        (["r", "--source", "camera:x"], 64, "camera:N"),
        (["r", "--source", "camera:0\nrun: true"], 64, "camera:N"),
        (["r", "--user", "a b"], 64, "no user's name"),
        (["r", "--calibration", "nowhere.yaml"], 66, "nowhere.yaml"),
        (["r", "--leader", str(data.path("calibrations/sim_640x480.yaml"))], 78, "--leader"),
        (["r", "--calibration", str(data.path("leaders/single_tag.yaml"))], 78, "--calibration"),
        (["r", "--dir", "/proc/nothing/here"], 74, "/proc/nothing/here: nothing can be written in /proc"),
    ],
)
def test_a_wrong_command_line_ends_in_words_and_leaves_nothing(tmp_path, monkeypatch, arguments, code, words):
    monkeypatch.chdir(tmp_path)
    exit_code, said = run("init", *arguments)
    assert exit_code == code, said
    assert words in said
    assert list(tmp_path.iterdir()) == []
