"""Ctrl-C, SIGTERM and SIGHUP, before a command has begun, while it works and when it has ended."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

import pilotfish

BEGIN = """
import signal, sys, time, types
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGTERM, signal.SIG_DFL)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
def command():
{command}
cli = types.ModuleType("pilotfish.cli")
cli.main = command
sys.modules["pilotfish.cli"] = cli
from pilotfish.__main__ import main
main()
"""


@contextmanager
def running(command, folder=None):
    """``pilotfish`` with a command of one's own, once it has said "begun"; with a folder, as a module in it."""
    script = BEGIN.format(command="\n".join(f"    {line}" for line in command.splitlines()))
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    words = ["-c", script]
    if folder is not None:
        (folder / "as_module.py").write_text(script)
        words, pipes["env"] = (
            ["-m", "as_module"],
            os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), *sys.path])},
        )
    with subprocess.Popen([sys.executable, *words], **pipes) as process:
        try:
            assert process.stdout.readline() == "begun\n"
            yield process
        finally:
            process.kill()


def outcome(process):
    """Its exit code, and what it said on both streams."""
    stdout, stderr = process.communicate(timeout=20)
    return process.returncode, stdout, stderr


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_a_command_cleans_up_and_ends_with_the_signal_s_code(number, code):
    with running("try:\n  print('begun', flush=True); time.sleep(60)\nfinally: print('cleaned up')") as process:
        process.send_signal(number)
        assert outcome(process) == (code, "cleaned up\n", "")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_bounce_does_not_break_into_the_cleaning_up(number):
    """The second one comes while the first is being handled, which is known because the command says so."""
    command = "try:\n  print('begun', flush=True); time.sleep(60)\n"
    command += "finally:\n  print('cleaning', flush=True); sys.stdin.readline(); print('cleaned up')"
    with running(command) as process:
        process.send_signal(number)
        assert process.stdout.readline() == "cleaning\n"
        process.send_signal(number)
        process.send_signal(number)
        assert outcome(process) == (128 + number, "cleaned up\n", "")


def test_an_interrupt_where_python_can_raise_nothing_still_ends_the_command():
    """A destructor is such a place: Python prints what is raised there, and goes on."""
    command = "class Odd:\n  def __del__(self):\n    print('begun', flush=True)\n    time.sleep(60)\n"
    command += "Odd()\ntime.sleep(60)"
    with running(command) as process:
        process.send_signal(signal.SIGINT)
        assert outcome(process) == (130, "", "")


def test_what_a_module_of_c_plus_plus_makes_of_an_interrupt_is_no_traceback():
    """pybind11 raises ImportError from whatever ends the import of a module."""
    command = "try:\n  print('begun', flush=True); time.sleep(60)\n"
    command += "except KeyboardInterrupt as error:\n  raise ImportError('initialization failed') from error"
    with running(command) as process:
        process.send_signal(signal.SIGINT)
        assert outcome(process) == (130, "", "")


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_an_interrupt_within_a_text_that_is_run_ends_it_with_the_same_code(tmp_path, number, code):
    """Then `python -m` would end itself by SIGINT, whichever signal it was."""
    with running("exec('print(\\'begun\\', flush=True); import time; time.sleep(60)')", tmp_path) as process:
        process.send_signal(number)
        assert outcome(process) == (code, "", "")


def test_an_error_of_its_own_after_an_interrupt_keeps_its_traceback():
    command = "try:\n  print('begun', flush=True); time.sleep(60)\nexcept KeyboardInterrupt:\n  pass\n"
    command += "raise ValueError('our own mistake')"
    with running(command) as process:
        process.send_signal(signal.SIGINT)
        code, _, stderr = outcome(process)
        assert code == 1
        assert "ValueError: our own mistake" in stderr


def test_nothing_large_is_imported_before_the_handlers_are_there():
    """Until then Ctrl-C prints a traceback: a fifth of a second, when typing and pkgutil were imported first."""
    script = "import sys, pilotfish.interrupts; print(*sys.modules)"
    here = os.environ | {"PYTHONPATH": str(Path(pilotfish.__file__).parents[1])}  # -S: without site-packages
    done = subprocess.run(
        [sys.executable, "-S", "-c", script], capture_output=True, text=True, timeout=60, check=True, env=here
    )
    large = {"typing", "pkgutil", "re", "contextlib", "pathlib", "importlib.util", "typer", "rich", "numpy"}
    assert large.isdisjoint(done.stdout.split())


def test_an_interrupt_after_the_end_prints_nothing():
    """While Python waits for a thread that is left."""
    command = "import threading\nmain = threading.main_thread()\n"
    command += (
        "def late():\n    while main.is_alive(): time.sleep(0.01)\n    print('begun', flush=True); time.sleep(60)\n"
    )
    command += "threading.Thread(target=late).start()"
    with running(command) as process:
        process.send_signal(signal.SIGINT)
        assert outcome(process) == (130, "", "")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_what_comes_while_python_is_taken_down_changes_nothing(number):
    """Its handlers are gone by then, and the system's would end it: the code of a command that is done is its own."""
    command = "import os\nclass Late:\n  def __del__(self, write=os.write, read=os.read):\n"
    command += "    write(1, b'begun\\n'); read(0, 1)\nsys.late = Late()"
    with running(command) as process:
        process.send_signal(number)
        assert outcome(process) == (0, "", "")


def test_a_child_that_is_started_deaf_hears_no_interrupt_and_its_parent_loses_none():
    """A terminal sends Ctrl-C to all processes of a command: one of them is to act on it."""
    deaf = "import signal; print(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))"
    command = "import os, subprocess\nfrom pilotfish.deaf_children import deaf_children\nprint('begun', flush=True)\n"
    command += "with deaf_children():\n  os.kill(os.getpid(), signal.SIGINT)\n"
    command += f"  print('deaf:', subprocess.check_output([sys.executable, '-c', {deaf!r}], text=True), end='')\n"
    command += "print('never said')"
    with running(command) as process:
        assert outcome(process) == (130, "deaf: True\n", "")


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


@pytest.mark.parametrize("name", ["SIGINT", "SIGHUP"])
def test_an_interrupt_that_is_ignored_stays_ignored(name):
    """As under nohup: the command goes on to its end."""
    script = f"import signal, sys; number = signal.{name}; signal.signal(number, signal.SIG_IGN)\n"
    script += "sys.argv = ['pilotfish', '--version']\nfrom pilotfish.__main__ import main\ntry: main()\n"
    script += "finally: assert signal.getsignal(number) is signal.SIG_IGN"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
