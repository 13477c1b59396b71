"""``pilotfish top`` on a terminal: whatever ends it, the terminal is as before."""

import os
import pty
import signal
import sys
import termios
import time

import pytest

from pilotfish.harness.ports import private_lcm_url

OTHER_SCREEN, OWN_SCREEN = b"\x1b[?1049h", b"\x1b[?1049l"
WITHIN_S = 30.0
RAW = termios.ECHO | termios.ICANON


@pytest.fixture
def top():
    """(its process, its terminal), once it has begun to set the terminal up."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.environ.update(TERM="xterm-256color")
        os.execv(sys.executable, [sys.executable, "-m", "pilotfish", "top", "--lcm-url", private_lcm_url()])
    try:
        yield pid, terminal
    finally:
        os.close(terminal)


def read_until(terminal, mark):
    shown, deadline = b"", time.monotonic() + WITHIN_S
    while mark not in shown:
        assert time.monotonic() < deadline, shown
        shown += os.read(terminal, 65536)
    return shown


def rest(terminal):
    """Until the process has ended: a terminal that nobody holds open cannot be read."""
    shown = b""
    while True:
        try:
            shown += os.read(terminal, 65536)
        except OSError:
            return shown


def end(pid, terminal, ask):
    """(exit code, all that was shown, flags of the terminal at the end); a copy of it is held open for these."""
    shown = read_until(terminal, OTHER_SCREEN)
    ask()
    said = rest(terminal)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), shown + said


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_while_the_terminal_is_set_up_leaves_it_as_it_was(top, number, code):
    pid, terminal = top
    before = termios.tcgetattr(terminal)[3] & RAW
    ended, shown = end(pid, terminal, lambda: os.kill(pid, number))
    assert ended == code
    assert shown.rindex(OWN_SCREEN) > shown.rindex(OTHER_SCREEN)
    assert b"Traceback" not in shown
    assert termios.tcgetattr(terminal)[3] & RAW == before


@pytest.mark.parametrize("key", [b"q", b"\x03"], ids=["q", "Ctrl-C"])
def test_a_key_ends_it_with_0(top, key):
    pid, terminal = top

    def press():
        read_until(terminal, b"Stop robot")  # its last line: the keys are read by now
        os.write(terminal, key)

    code, shown = end(pid, terminal, press)
    assert code == 0
    assert b"Traceback" not in shown
