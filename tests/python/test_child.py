"""Children are never left behind, and what they said last is in the error."""

import contextlib
import gc
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

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


def processes_of_this_test(word):
    """Numbers of the processes that have the word in their command lines."""
    found = []
    for file in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):  # it has ended in between
            if word.encode() in file.read_bytes().split(b"\0"):
                found.append(int(file.parent.name))
    return found


@pytest.mark.skipif(shutil.which("setpriv") is None, reason="no setpriv (util-linux)")
@pytest.mark.parametrize("way", ["a program", "a worker of Python's own"])
def test_a_child_ends_also_when_its_parent_is_killed(tmp_path, way):
    """SIGKILL leaves the parent no time. The child is known by a word of its own in its command line or name."""
    mark = f"mark-{os.getpid()}-{way.replace(' ', '-').replace(chr(39), '')}"
    if way == "a program":
        script = "import sys\nfrom pathlib import Path\nfrom pilotfish.harness.child import Child\n"
        script += (
            f"with Child([sys.executable, '-c', 'import time; time.sleep(600)', {mark!r}], Path('.'), 'c') as child:\n"
        )
        script += "    print(child.process.pid, flush=True); child.process.wait()\n"
    else:
        script = (
            "import os, sys, subprocess\nwords = 'from pilotfish.end_with_parent import end_with_parent as end; '\n"
        )
        script += "words += f'end({os.getpid()}); print(1, flush=True); import time; time.sleep(600)'\n"
        script += f"child = subprocess.Popen([sys.executable, '-c', words, {mark!r}], stdout=subprocess.PIPE)\n"
        script += "child.stdout.readline(); print(child.pid, flush=True); child.wait()\n"
    with subprocess.Popen([sys.executable, "-c", script], cwd=tmp_path, stdout=subprocess.PIPE, text=True) as parent:
        child = int(parent.stdout.readline())
        deadline = time.monotonic() + 30.0
        while child not in processes_of_this_test(mark) and time.monotonic() < deadline:  # it has become the program
            time.sleep(0.01)
        assert child in processes_of_this_test(mark)
        parent.kill()
    while child in processes_of_this_test(mark) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert child not in processes_of_this_test(mark)


def test_a_worker_whose_parent_is_gone_already_ends_at_once():
    script = "from pilotfish.end_with_parent import end_with_parent\nend_with_parent(-1)\nprint('never said')"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (-15, "")


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


# An interrupt can come between any two instructions of Python. `interrupted_at` raises one at each of them in turn, in
# the functions that have to do with a child, as a signal's handler would: it is called there, and raises.
_WATCHED = ("child.py", "subprocess.py", "held_interrupts.py")


def interrupted_at(step, work):
    """Runs ``work()`` and sends SIGINT at the ``step``'th call or return of a function there; whether it came to it."""
    steps = 0

    def count(frame, event, _arg):
        nonlocal steps
        if Path(frame.f_code.co_filename).name in _WATCHED:
            steps += 1
            if steps == step:
                signal.raise_signal(signal.SIGINT)  # its handler runs before the next instruction of this frame

    sys.setprofile(count)
    try:
        work()
    except KeyboardInterrupt:
        pass
    finally:
        sys.setprofile(None)
    return steps >= step


def has_ended(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


@pytest.fixture
def _raised_interrupts(monkeypatch):
    """As in a command: what cannot be raised, because a destructor runs, is no failure (it is raised later)."""
    otherwise = sys.unraisablehook
    monkeypatch.setattr(sys, "unraisablehook", lambda what: what.exc_type is KeyboardInterrupt or otherwise(what))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("_raised_interrupts")
def test_an_interrupt_at_any_moment_of_asking_leaves_a_child_that_can_be_ended(tmp_path):
    """Python's own Popen.poll() keeps a lock for ever if the interrupt comes behind acquire(), and its wait() then
    waits for that lock."""
    step = 0
    while True:
        step += 1
        with Child(["sleep", "600"], tmp_path, "child") as child:
            came = interrupted_at(step, child.poll)
            assert not child.process._waitpid_lock.locked(), f"at step {step}"
        assert child.process.returncode == -15
        if not came:
            break
    assert step > 5  # else nothing was interrupted


@pytest.mark.usefixtures("_raised_interrupts")
def test_an_interrupt_at_any_moment_of_starting_and_ending_leaves_no_process(tmp_path):
    step, started = 0, {}

    def live():
        with Child(["sleep", "600"], tmp_path, "child") as child:
            started[step] = child.process.pid

    came = True
    while came:
        step += 1
        came = interrupted_at(step, live)
    gc.collect()  # what tracebacks held
    assert [at for at, pid in started.items() if not has_ended(pid)] == []
    assert step > 20  # else nothing was interrupted
