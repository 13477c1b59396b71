"""What the programs tell a service manager (systemd's protocol, sd_notify(3)), with this test as the manager."""

import os
import socket
import subprocess
from contextlib import contextmanager

import pytest
from PIL import Image

from build_tree import built
from pilotfish import data as shipped
from pilotfish.harness.executables import COORDINATOR, find_executable
from scenes import leader_pictures

PROBE = built("service_probe")
PERIOD_US = 2_000_000


@contextmanager
def manager(address):
    """A service manager's socket, as a path or as an abstract name."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listening:
        listening.bind(address.replace("@", "\0", 1) if address.startswith("@") else address)
        yield listening


def said_to(listening):
    """Every message that has arrived; the programs have ended, so none is under way."""
    listening.setblocking(False)
    messages = []
    while True:
        try:
            messages.append(listening.recv(4096).decode())
        except BlockingIOError:
            return messages


def probe(*words, **environment):
    done = subprocess.run(
        [PROBE, *words], env={**os.environ, **environment}, capture_output=True, text=True, timeout=20, check=True
    )
    return done.stdout.strip()


@pytest.mark.parametrize("abstract", [False, True])
def test_the_manager_hears_ready_status_and_stopping(tmp_path, abstract):
    address = f"@pilotfish-test-{os.getpid()}" if abstract else str(tmp_path / "notify")
    with manager(address) as listening:
        probe("ready=camera 0", "status=lost", "stopping", NOTIFY_SOCKET=address)
        assert said_to(listening) == ["READY=1\nSTATUS=camera 0", "STATUS=lost", "STOPPING=1\nSTATUS=stopping"]


def test_a_status_of_two_lines_cannot_say_anything_else(tmp_path):
    with manager(str(tmp_path / "notify")) as listening:
        probe("status=lost\nWATCHDOG=1", NOTIFY_SOCKET=str(tmp_path / "notify"))
        assert said_to(listening) == ["STATUS=lost WATCHDOG=1"]


def test_progress_feeds_the_watchdog_four_times_a_period_however_often_it_is_called(tmp_path):
    """10 s of progress every 20 ms are 501 calls; one in each 0.5 s goes out: at 0, 0.5, ... 10 s, that is 21."""
    calls = [f"progress={t_us}" for t_us in range(0, 10_000_001, 20_000)]
    with manager(str(tmp_path / "notify")) as listening:
        received = []
        for first in range(0, len(calls), 200):  # the kernel keeps 10 messages; these hold 8 or 9
            probe(*calls[first : first + 200], NOTIFY_SOCKET=str(tmp_path / "notify"), WATCHDOG_USEC=str(PERIOD_US))
            received += said_to(listening)
    assert set(received) == {"WATCHDOG=1"}
    assert len(received) == 21


def test_without_progress_the_watchdog_starves(tmp_path):
    with manager(str(tmp_path / "notify")) as listening:
        address = str(tmp_path / "notify")
        probe("ready=x", "status=y", "stopping", NOTIFY_SOCKET=address, WATCHDOG_USEC=str(PERIOD_US))
        assert not any("WATCHDOG" in message for message in said_to(listening))


def test_a_manager_that_reads_nothing_holds_up_nobody(tmp_path):
    """The kernel keeps net.unix.max_dgram_qlen messages (10); sd_notify(3) would wait at the next."""
    calls = [f"progress={t_us}" for t_us in range(0, 1000 * PERIOD_US, PERIOD_US)]
    with manager(str(tmp_path / "notify")) as listening:
        probe(*calls, NOTIFY_SOCKET=str(tmp_path / "notify"), WATCHDOG_USEC=str(PERIOD_US))
        assert 1 <= len(said_to(listening)) < 1000


@pytest.mark.parametrize("address", ["", "/", "relative", "/no/such/socket", "@", "/" + 200 * "x"])
def test_without_a_manager_every_call_does_nothing(address):
    assert probe("ready=x", "progress=0", "stopping", NOTIFY_SOCKET=address) == "none"


@pytest.mark.parametrize(
    ("usec", "pid", "period"),
    [
        ("2000000", None, "2000000"),
        ("2000000", "1", "none"),  # meant for another process
        ("0", None, "none"),
        ("-5", None, "none"),
        ("2s", None, "none"),
        ("99999999999999999999", None, "none"),
    ],
)
def test_the_watchdog_period_is_read_only_where_it_is_meant_for_this_process(usec, pid, period):
    pid_variable = {"WATCHDOG_PID": pid} if pid else {}
    assert probe(WATCHDOG_USEC=usec, **pid_variable) == period


def test_the_coordinator_says_when_it_is_ready_and_when_it_ends(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    frames = leader_pictures(3)
    for k, frame in enumerate(frames):
        Image.fromarray(frame.image).save(folder / f"{k}.png")
    rows = [f"{k}.png,{frame.utime}" for k, frame in enumerate(frames)]
    (folder / "frames.csv").write_text("\n".join(["file,utime_us", *rows]) + "\n")
    command = [find_executable(COORDINATOR), "--config", shipped.path("config/line.yaml")]
    command += ["--source", f"images:{folder}", "--lcm-url", "memq://"]
    with manager(str(tmp_path / "notify")) as listening:
        environment = {**os.environ, "NOTIFY_SOCKET": str(tmp_path / "notify")}
        subprocess.run(command, env=environment, capture_output=True, timeout=60, check=True)
        first, *_, last = said_to(listening)
    assert first.startswith("READY=1\n") and str(folder) in first
    assert last.startswith("STOPPING=1\n")
