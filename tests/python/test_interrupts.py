"""Ctrl-C before the command has begun."""

from __future__ import annotations

import signal
import subprocess
import sys


def test_ctrl_c_while_modules_are_imported_ends_quietly_with_130(tmp_path):
    """A package that takes its time to be imported stands before typer, which the command line imports first."""
    (tmp_path / "typer.py").write_text("import time\nprint('importing', flush=True)\ntime.sleep(60)\n")
    # What starts the tests may ignore interrupts, as a shell does for a job in the background; then a child would, too.
    script = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    script += f"sys.path.insert(0, {str(tmp_path)!r}); from pilotfish.__main__ import main; main()"
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        assert running.stdout.readline() == b"importing\n"
        running.send_signal(signal.SIGINT)
        assert running.wait(20) == 130
        assert running.stderr.read() == b""


def test_an_interrupt_that_is_ignored_stays_ignored(tmp_path):
    """As under nohup: the command goes on to its end."""
    script = "import signal, sys; signal.signal(signal.SIGINT, signal.SIG_IGN); sys.argv = ['pilotfish', '--version']\n"
    script += "from pilotfish.__main__ import main\ntry: main()\n"
    script += "finally: assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
