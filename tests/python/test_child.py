"""Children are never left behind, and what they said last is in the error."""

import socket
import sys

import pytest

from pilotfish.errors import HarnessError
from pilotfish.harness import child as child_module
from pilotfish.harness.child import Child
from pilotfish.harness.ports import free_udp_port, private_lcm_url


def python(code, folder):
    return Child([sys.executable, "-c", code], folder, "child")


def test_a_child_that_still_runs_is_terminated_on_leaving(tmp_path):
    with python("import time; print('up', flush=True); time.sleep(600)", tmp_path) as child:
        child.wait_until(lambda: "up" in child.stdout(), 30, "being up")
        assert child.process.poll() is None
    assert child.process.returncode == -15


def test_a_child_that_ignores_sigterm_is_killed(tmp_path, monkeypatch):
    monkeypatch.setattr(child_module, "TERMINATE_WITHIN_S", 0.2)
    code = "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN);print('up', flush=True); time.sleep(600)"
    with python(code, tmp_path) as child:
        child.wait_until(lambda: "up" in child.stdout(), 30, "being up")
    assert child.process.returncode == -9


def test_a_child_is_terminated_also_when_the_block_fails(tmp_path):
    with pytest.raises(ZeroDivisionError), python("import time; time.sleep(600)", tmp_path) as child:
        raise ZeroDivisionError
    assert child.process.returncode is not None


def test_a_child_that_ends_too_early_is_an_error_with_its_last_output(tmp_path):
    code = "import sys; [print(f'line {i}', file=sys.stderr) for i in range(40)]; sys.exit(78)"
    with python(code, tmp_path) as child, pytest.raises(HarnessError) as caught:
        child.wait_until(lambda: False, 30, "being ready")
    assert "ended with 78 before being ready" in str(caught.value)
    assert "line 39" in str(caught.value)
    assert "line 24" not in str(caught.value)  # the last 15 of 40 lines are enough


def test_waiting_is_bounded(tmp_path):
    with (
        python("import time; time.sleep(600)", tmp_path) as child,
        pytest.raises(HarnessError, match="being ready: not within 0 s"),
    ):
        child.wait_until(lambda: False, 0.0, "being ready")


def test_a_megabyte_of_output_does_not_block_a_child(tmp_path):
    with python("print('x' * 1_000_000)", tmp_path) as child:
        assert child.process.wait(30) == 0
        assert len(child.stdout()) == 1_000_001


def test_every_call_gives_another_free_port():
    ports = {free_udp_port() for _ in range(20)}
    assert len(ports) == 20
    assert all(20000 <= port < 32000 for port in ports)


def test_a_port_that_somebody_holds_is_not_given_out():
    first = free_udp_port()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as holder:
        following = first + 1 if first + 1 < 32000 else 20000
        holder.bind(("", following))
        after = free_udp_port()
        assert after != following
        assert free_udp_port() not in (first, following, after)


def test_a_private_bus_stays_on_this_host():
    assert "ttl=0" in private_lcm_url()
