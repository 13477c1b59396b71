"""Robots on hosts of their own: the real programs in network namespaces, with the network between them disturbed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
BENCH = ROOT / "bench" / "network"


def without_namespaces():
    """Why none can be made here, or nothing."""
    words = ["unshare", *([] if os.geteuid() == 0 else ["--user", "--map-root-user"]), "--net", "ip", "link"]
    try:
        return subprocess.run(words, capture_output=True, text=True, check=False).stderr
    except OSError as error:
        return str(error)


REASON = without_namespaces()
needs_namespaces = pytest.mark.skipif(bool(REASON), reason=f"no network namespace: {REASON.strip()}")


def bench(*words, **options):
    command = [sys.executable, BENCH, *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, **options)


def in_bench(code):
    """What a program prints that runs beside the benchmark's files, whose names are not packages of ours."""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=BENCH, capture_output=True, text=True, check=True, timeout=60
    )
    return json.loads(done.stdout)


@needs_namespaces
def test_in_lock_step_nothing_that_happens_between_the_hosts_changes_one_bit_of_the_drive(tmp_path):
    words = ["--part", "lockstep", "--duration-s", 1.5, "--disturbance", "loss-50", "--disturbance", "interface-down"]
    done = bench(*words, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    rows = json.loads((tmp_path / "network.json").read_text())["lockstep"]["rows"]
    assert [row["identical"] for row in rows] == [True] * 6
    for scenario in ("line", "circle"):
        ideal, lossy, cut = (row["watched"] for row in rows if row["scenario"] == scenario)
        # Each of the robot's 45 exposures has its pose, command, observation and status: at least some 100 messages.
        # Half of them are lost, with a standard deviation of sqrt(100) / 2 = 5: four of those below and above. What
        # the disturbed run sends between pictures differs by its time, so the bounds are wider than that.
        assert ideal > 100
        assert 0.25 * ideal < lossy < 0.75 * ideal
        assert cut < 0.5 * ideal


@needs_namespaces
def test_wheels_whose_coordinators_host_is_cut_off_stand_when_the_last_command_has_expired(tmp_path):
    done = bench("--part", "wheels", "--quick", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    milliseconds = json.loads((tmp_path / "network.json").read_text())["wheels"]["ms"]
    assert len(milliseconds) == 3
    # A command is at most a period (33 ms) old when the link ends, and is good for 95 ms: no zero before 62 ms but for
    # the time that taking down the link needs, which is included.
    assert min(milliseconds) > 95 - 33 - 15


def processes_of(folder):
    """Those that run with a file in the folder on their command line."""
    found = []
    for file in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if str(folder).encode() in file.read_bytes():
                found.append(int(file.parent.name))
        except OSError:
            continue
    return found


def hear_interrupts():
    """What starts the tests may ignore them, as a shell does for a job in the background, and a child inherits that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@needs_namespaces
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_whatever_ends_the_benchmark_no_program_of_it_is_left(tmp_path, how):
    """And with its last process and descriptor the kernel removes a network namespace that has no name."""
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    words = [sys.executable, BENCH, "--part", "lockstep", "--duration-s", "600", "--out", tmp_path / "out"]
    before = subprocess.run(["ip", "netns", "list"], capture_output=True, text=True, check=True).stdout
    child = subprocess.Popen(
        words,
        env=os.environ | {"TMPDIR": str(temporary)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        preexec_fn=hear_interrupts,
    )
    try:
        wait_until(lambda: len(processes_of(temporary)) >= 2, "two simulators, which record into the folder")
    finally:
        child.send_signal(how)
        try:
            child.wait(30)
        finally:
            child.kill()  # or what the test has failed to end would take the time of all that come after
    wait_until(lambda: not processes_of(temporary), "the end of all")
    if how != signal.SIGKILL:
        assert child.returncode in (128 + how, -how)
        assert not list(temporary.glob("pilotfish-network-*"))
    assert subprocess.run(["ip", "netns", "list"], capture_output=True, text=True, check=True).stdout == before


def wait_until(condition, what):
    end_s = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < end_s, f"{what}: not within 30 s"
        time.sleep(0.05)


def test_a_relayed_packet_is_lost_delayed_and_reordered_as_often_as_it_is_asked_for():
    code = """
import json, random
from disturbances import Disturbance
from relay import delay_s
rng = random.Random(1)
kinds = [Disturbance("", loss=0.2), Disturbance("", delay_ms=100.0, jitter_ms=25.0),
         Disturbance("", delay_ms=50.0, reorder=0.25)]
print(json.dumps([[delay_s(kind, rng) for _ in range(10000)] for kind in kinds]))
"""
    lossy, late, reordered = in_bench(code)
    # Binomial: 0.2 of 10000 with a standard deviation of sqrt(0.2 0.8 / 10000) = 0.004; four of them.
    assert lossy.count(None) / 10000 == pytest.approx(0.2, abs=0.016)
    assert set(lossy) == {None, 0.0}
    # The mean of 10000 has a standard deviation of 25 / 100 = 0.25 ms, the standard deviation one of 0.18 ms.
    assert np.mean(late) == pytest.approx(0.100, abs=0.001)
    assert np.std(late) == pytest.approx(0.025, abs=0.001)
    assert reordered.count(0.0) / 10000 == pytest.approx(0.25, abs=0.018)
    assert set(reordered) == {0.0, 0.05}


def test_netem_is_asked_for_the_same_in_its_own_words():
    code = """
import json
from disturbances import DISTURBANCES, netem_words
print(json.dumps({name: netem_words(disturbance) for name, disturbance in DISTURBANCES.items()}))
"""
    words = in_bench(code)
    assert words["none"] == words["link-down"] == []
    assert words["loss-5"] == ["netem", "loss", "5%"]
    assert words["delay-100"] == ["netem", "delay", "100ms", "25ms", "distribution", "normal"]
    assert words["reorder"] == ["netem", "delay", "50ms", "reorder", "25%"]


def test_without_the_programs_it_says_what_to_install(tmp_path):
    done = bench("--out", tmp_path, env=os.environ | {"PATH": str(tmp_path)})
    assert done.returncode == 69
    assert "apt install iproute2 util-linux" in done.stderr


@needs_namespaces
@pytest.mark.parametrize("wrong", [("--part", "radio"), ("--disturbance", "fog"), ("--switch", "hub")])
def test_an_unknown_part_disturbance_or_switch_is_refused_with_those_that_exist(tmp_path, wrong):
    done = bench(*wrong, "--out", tmp_path)
    assert done.returncode == 2
    assert "there is" in done.stderr and wrong[1] in done.stderr
