"""``pilotfish doctor`` on this machine, whatever it is like."""

import json
import subprocess
import sys
import threading
from io import StringIO

import lcm
import pytest
from rich.console import Console
from typer.testing import CliRunner

from pilotfish import data, doctor
from pilotfish.cli import app
from pilotfish.cli.advice import print_finding
from pilotfish.doctor import Host, Verdict, network
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.pilotfish.command_t import command_t

CHECKS = {
    *("pilotfish-coordinator", "pilotfish-base", "pilotfish-sim", "pilotfish-spy", "liblcm"),
    *("versions", "lcm tools", "java", "port", "CPU governor"),
    *("multicast route", "multicast", "receive buffer", "bus", "firewall", "camera", "serial line"),
    *("real time", "clock source", "time of day", "disk"),
}


def run(*arguments):
    command = [sys.executable, "-m", "pilotfish", "doctor", "--listen-s", "0.1", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def test_every_check_has_a_verdict_and_the_exit_code_says_if_one_is_wrong():
    done = run("--json", "--lcm-url", private_lcm_url())
    report = json.loads(done.stdout)
    assert {finding["check"] for finding in report["findings"]} >= CHECKS
    verdicts = [finding["verdict"] for finding in report["findings"]]
    assert set(verdicts) <= {"ok", "note", "wrong"}
    assert report["ok"] == ("wrong" not in verdicts)
    assert done.returncode == (0 if report["ok"] else 1), done.stderr
    assert all(finding["advice"] for finding in report["findings"] if finding["verdict"] == "wrong")


def test_in_a_pipe_nothing_is_wrapped():
    """A line for each finding and one for each advice, whatever their length, as in the JSON of the same machine."""
    url = private_lcm_url()
    findings = json.loads(run("--json", "--lcm-url", url).stdout)["findings"]
    lines = [line.strip() for line in run("--lcm-url", url).stdout.splitlines()]
    assert {line for line in lines if line.startswith("->")} == {f"-> {each['advice']}" for each in findings} - {"-> "}
    for finding in findings:
        assert any(line.startswith(f"{finding['verdict']:<7}{finding['check']}") for line in lines), finding
    assert len(lines) == len(findings) + sum(bool(finding["advice"]) for finding in findings) + 1


COMMAND = "sudo ip link set lo up multicast on; sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1; " * 2


@pytest.mark.parametrize(("terminal", "height"), [(True, 3), (False, 2)])
def test_commands_are_never_wrapped_and_sentences_on_a_terminal_alone(terminal, height):
    """94 characters of a sentence on 80 columns, of which 28 are taken, need two lines."""
    shown = StringIO()
    console = Console(file=shown, force_terminal=terminal, width=80, color_system=None)
    print_finding(console, [("note", 5, ""), ("multicast route", 21, "")], "word " * 18 + "last", COMMAND + "end")
    lines = shown.getvalue().splitlines()
    assert lines[-1] == f"       -> {COMMAND}end"
    assert len(lines) == height
    assert not terminal or max(len(line) for line in lines[:-1]) <= 80


def test_two_coordinators_of_one_name_end_it_with_1():
    url = private_lcm_url()
    over = threading.Event()

    def speak():
        bus = lcm.LCM(url)
        messages = [command_t(), command_t()]
        messages[0].session, messages[1].session = 7, 8
        while not over.wait(0.01):
            for message in messages:
                bus.publish("ROBOT1_COMMAND", message.encode())

    speaker = threading.Thread(target=speak)
    speaker.start()
    try:
        done = run("--json", "--lcm-url", url, "--listen-s", "1")
    finally:
        over.set()
        speaker.join()
    assert done.returncode == 1
    wrong = [finding for finding in json.loads(done.stdout)["findings"] if finding["verdict"] == "wrong"]
    assert any("2 send on ROBOT1_COMMAND" in finding["seen"] for finding in wrong)


def test_multicast_comes_back_where_there_is_a_route():
    found = network.check_multicast(network.group_of(private_lcm_url()))
    assert found.verdict is not Verdict.wrong, found


def test_a_bare_machine_crashes_nothing(tmp_path, monkeypatch):
    """No files at all, no programs, and every question to the kernel refused."""

    class Bare(Host):
        def run(self, command):
            return None

        def free_bytes(self, folder):
            raise PermissionError

        def limit(self, which):
            raise OSError("no limits here")

        def is_root(self):
            return False

        def clock_is_synchronized(self):
            raise AttributeError("ntp_adjtime")

    monkeypatch.setenv("PILOTFISH_BIN", str(tmp_path))
    found = {finding.check: finding for finding in doctor.examine(Bare(tmp_path), lcm_url="memq://", listen_s=0.05)}
    assert found["pilotfish-coordinator"].verdict is Verdict.wrong
    for check in ("disk", "real time", "time of day"):
        assert found[check].verdict is Verdict.note
        assert "could not be looked at" in found[check].seen


@pytest.mark.parametrize("url", ["udpm://1.2.3.4:7667", "nonsense", "udpm://239.255.76.67:99999"])
def test_a_url_that_is_none_is_told_and_crashes_nothing(url):
    done = run("--json", "--lcm-url", url)
    assert done.returncode == 1, done.stdout + done.stderr
    assert any(finding["verdict"] == "wrong" for finding in json.loads(done.stdout)["findings"])


def test_a_configuration_adds_its_name_and_its_camera():
    done = run("--json", "--lcm-url", private_lcm_url(), "--config", str(data.path("config/line.yaml")))
    found = {finding["check"]: finding for finding in json.loads(done.stdout)["findings"]}
    assert found["name"]["seen"] == "robot1 is free: nobody sends its commands"
    assert "source lcm is no camera of this host" in found["camera of the robot"]["seen"]


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--config", "nowhere.yaml"], 66, "nowhere.yaml"),
        (["--seconds", "5"], 64, "--following"),
        (["--following", "robot1", "--seconds", "nan"], 64, "1 to 3600"),
        (["--following", "robot1", "--seconds", "0"], 64, "1 to 3600"),
        (["--following", "a b"], 64, "1 to 32 letters"),
        (["--following", "robot1", "--lcm-url", "nonsense"], 69, "cannot be opened"),
        (["--following", "robot1", "--config", "nowhere.yaml"], 66, "nowhere.yaml"),
    ],
)
def test_a_wrong_command_line_ends_in_words(arguments, code, words):
    done = CliRunner().invoke(app, ["doctor", "--listen-s", "0.1", *arguments])
    assert done.exit_code == code, done.output
    assert words in " ".join(done.stderr.split())


def test_a_wrong_command_line_ends_in_words_also_in_a_process_of_its_own():
    done = run("--config", "nowhere.yaml")
    assert done.returncode == 66, done.stdout + done.stderr
    assert "nowhere.yaml" in done.stderr
    assert "Traceback" not in done.stderr
