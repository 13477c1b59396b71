"""The compiled baselines: builds them if they are not there, and loads them."""

from __future__ import annotations

import importlib
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from pilotfish.errors import PilotfishError

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "bench"
MODULE = "bench_vision_baselines"


class BaselinesError(PilotfishError):
    """The baselines cannot be built or loaded; the message says what is missing."""

    exit_code = 69


def load_compiled(say: Callable[[str], None]) -> ModuleType:
    """ViSP's and libapriltag's trackers, built now if need be."""
    settings = ["-DPILOTFISH_BENCH=ON", "-DPILOTFISH_PYTHON=OFF", "-DCMAKE_BUILD_TYPE=Release"]
    configure = ["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", f"-DPython_EXECUTABLE={sys.executable}", *settings]
    if not (BUILD / "build.ninja").exists():
        say(f"configuring {BUILD.relative_to(ROOT)}")
        _run(configure)
    if not list(BUILD.glob(f"bench/{MODULE}*.so")):
        say(f"building {MODULE} from bench/vision/baselines.cpp")
    _run(["cmake", "--build", BUILD, "--target", MODULE])  # does nothing if nothing changed
    sys.path.insert(0, str(BUILD / "bench"))
    return importlib.import_module(MODULE)


def _run(command: list[object]) -> None:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise BaselinesError(f"{' '.join(map(str, command))} failed:\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
