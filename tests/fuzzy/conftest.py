import subprocess
from pathlib import Path

import fuzzy_reference
import numpy as np
import pytest
from compiled import compile_program, pkg_config

from pilotfish import fuzzy


@pytest.fixture(scope="session")
def controller():
    """The shipped controller."""
    return fuzzy.load_controller(fuzzy_reference.DATA)


@pytest.fixture
def data():
    """The shipped file, read by PyYAML; a fresh copy that a test may break."""
    return fuzzy_reference.read()


@pytest.fixture
def gaussian_data(data):
    """The shipped table with a Gaussian in place of every triangle, of about the same width."""
    for name in ("E", "EC", "U"):
        for label, spec in data[name]["terms"].items():
            if "triangle" in spec:
                a, b, c = spec["triangle"]
                data[name]["terms"][label] = {"gaussian": {"mean": b, "sigma": (c - a) / 5}}
    return data


class Fuzzylite:
    """fuzzylite 6, on a controller of ours or a text in its own language."""

    def __init__(self, program: Path, folder: Path) -> None:
        self._program, self._file = program, folder / "controller.fll"

    def _run(self, controller: fuzzy.Controller | str, what: str, said: str = "") -> str:
        self._file.write_text(controller if isinstance(controller, str) else fuzzy.to_fll(controller))
        command = [self._program, self._file, what]
        return subprocess.run(command, input=said, check=True, capture_output=True, text=True, timeout=120).stdout

    def outputs(self, controller: fuzzy.Controller | str, e: np.ndarray, ec: np.ndarray, resolution: int) -> np.ndarray:
        lines = "".join(f"{x!r} {y!r}\n" for x, y in zip(e.tolist(), ec.tolist(), strict=True))
        return np.array(self._run(controller, str(resolution), lines).split(), dtype=float)

    def exported(self, controller: fuzzy.Controller | str) -> str:
        return self._run(controller, "export")


@pytest.fixture(scope="session")
def fuzzylite(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fuzzylite")
    source = Path(__file__).with_name("fuzzylite_oracle.cpp")
    return Fuzzylite(compile_program(folder, [source], "-O2", *pkg_config("fuzzylite")), folder)
