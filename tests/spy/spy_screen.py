"""A virtual screen, and hands and eyes for the windows on it."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PIL import ImageGrab

from pilotfish.harness.executables import find_executable

LAUNCHER = find_executable("pilotfish-spy")
LCM_JAR = Path("/usr/share/java/lcm.jar")
# As the launcher finds them: installed and in a build tree, share/ is beside bin/ or apps/.
_FOLDER = Path(os.environ.get("PILOTFISH_LCMTYPES_JAR", LAUNCHER.parent.parent / "share/pilotfish/x")).parent
JARS = [_FOLDER / "pilotfish-lcmtypes.jar", _FOLDER / "pilotfish-spy.jar"]
PATIENCE_S = 60.0  # a cold Java on a busy machine
ROW_PX = 16  # of lcm-spy's table of channels


def skip_unless(*programs: str) -> None:
    """Skips unless there are these programs and what lcm-spy itself needs; `program:package` where the names differ."""
    for program in programs:
        name, _, package = program.partition(":")
        if not shutil.which(name):
            pytest.skip(f"no {name} (package {package or name})")
    for jar, package in {"lcm.jar": "liblcm-java", "jchart2d.jar": "libjchart2d-java"}.items():
        if not Path("/usr/share/java", jar).exists():
            pytest.skip(f"no {jar} (package {package})")


@contextmanager
def virtual_screen(width: int = 1280, height: int = 1020) -> Iterator[str]:
    """Its DISPLAY."""
    read, write = os.pipe()
    os.set_inheritable(write, True)
    # Without -noreset the server starts anew whenever its last client leaves, and refuses who comes at that moment.
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as answer:
        number = answer.readline().strip()  # comes when the screen is ready; nothing if Xvfb ends
    try:
        assert number, "Xvfb did not start"
        yield f":{number}"
    finally:
        server.terminate()
        server.wait()


class Screen:
    """What somebody does who sits in front of a display."""

    def __init__(self, display: str) -> None:
        self.display = display

    def xdotool(self, *words: object) -> list[str]:
        done = subprocess.run(
            ["xdotool", *map(str, words)],
            env={**os.environ, "DISPLAY": self.display},
            capture_output=True,
            text=True,
            check=False,
        )
        return done.stdout.splitlines()

    def pixels(self) -> np.ndarray:
        """(H, W, 3) uint8."""
        return np.asarray(ImageGrab.grab(xdisplay=self.display).convert("RGB"))

    def windows(self, title: str) -> list[str]:
        """Those that are visible, by a regular expression of their title."""
        return self.xdotool("search", "--onlyvisible", "--name", title)

    def table(self) -> str:
        """lcm-spy's table of channels. A search in which another window closes ends without a result: asked again."""
        deadline = time.monotonic() + PATIENCE_S
        while len(found := self.xdotool("search", "--name", "^LCM Spy$")) != 1:
            assert time.monotonic() < deadline, f"lcm-spy's table is not there: {found}"
            time.sleep(0.05)
        return found[0]

    def click(self, row: int, *, button: int = 1, times: int = 1) -> None:
        """On a row of the table."""
        y = 20 + ROW_PX * row + ROW_PX // 2
        to = ["mousemove", "--window", self.table(), 60, y]
        self.xdotool(*to, "click", "--repeat", times, "--delay", 60, button)

    def rows(self) -> int:
        """Lines of the table with letters in them, of the first eleven; the first is below its head."""
        shown = self.pixels()
        lines = [shown[20 + ROW_PX * k : 20 + ROW_PX * (k + 1), :100] for k in range(11)]
        return sum(bool((line.sum(axis=2) < 200).sum() > 40) for line in lines)

    def close(self, window: str) -> None:
        """As the cross of a window manager does it: asks the window to close. (xdotool destroys it without asking.)"""
        _ask_to_close(self.display, int(window))


class _ClientMessage(ctypes.Structure):
    """XClientMessageEvent of Xlib, with the padding of its union XEvent."""

    _fields_ = [
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 5),
        ("padding", ctypes.c_long * 24),
    ]


def _ask_to_close(display_name: str, window: int) -> None:
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.restype = ctypes.c_ulong
    x11.XInternAtom.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
    x11.XSendEvent.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = x11.XOpenDisplay(display_name.encode())
    assert display, f"no display {display_name}"
    client_message = 33  # of X.h
    event = _ClientMessage(type=client_message, window=window, format=32)
    event.message_type = x11.XInternAtom(display, b"WM_PROTOCOLS", 0)
    event.data[0] = x11.XInternAtom(display, b"WM_DELETE_WINDOW", 0)
    x11.XSendEvent(display, window, 0, 0, ctypes.byref(event))
    x11.XCloseDisplay(display)  # sends what is in the queue
