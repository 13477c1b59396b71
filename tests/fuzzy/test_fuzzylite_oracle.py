"""The shipped controller against fuzzylite 6, over the whole grid of inputs.

fuzzylite samples its centroid (midpoint rule), so it is refined until it agrees with itself first. What
remains between two resolutions is a bound on its own error, and we have to be inside it.
"""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from fuzzy_builders import make_controller

from pilotfish import fuzzy


def to_fll(data: dict) -> str:
    """The file of data/fuzzy, as PyYAML reads it, in fuzzylite's language."""

    def variable(kind: str, name: str) -> list[str]:
        lo, hi = data[name]["universe"]
        lines = [f"{kind}: {name}", "  enabled: true", f"  range: {lo!r} {hi!r}"]
        for label, spec in data[name]["terms"].items():
            ((shape, p),) = spec.items()
            numbers = [p["mean"], p["sigma"]] if shape == "gaussian" else p
            lines.append(f"  term: {label} {shape.capitalize()} " + " ".join(repr(float(x)) for x in numbers))
        return lines

    lines = ["Engine: pilotfish"]
    lines += [*variable("InputVariable", "E"), "  lock-range: true"]  # lock-range: inputs saturate
    lines += [*variable("InputVariable", "EC"), "  lock-range: true"]
    lines += variable("OutputVariable", "U")
    lines += [
        "  aggregation: Maximum",
        "  defuzzifier: Centroid 100",
        "  default: nan",
        "  lock-previous: false",
    ]
    lines += ["RuleBlock: table", "  enabled: true", "  conjunction: Minimum", "  disjunction: none"]
    lines += ["  implication: Minimum", "  activation: General"]
    for row in data["E"]["terms"]:
        for column, cell in zip(data["rules"]["columns"], data["rules"][row], strict=True):
            lines.append(f"  rule: if E is {row} and EC is {column} then U is {cell}")
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def fuzzylite(tmp_path_factory):
    """ask(data, e, ec, resolution) -> outputs, by a program built here from fuzzylite_oracle.cpp."""
    compiler = os.environ.get("CXX") or shutil.which("c++")
    found = shutil.which("pkg-config") and subprocess.run(["pkg-config", "--exists", "fuzzylite"], check=False)
    if not compiler or not found or found.returncode != 0:
        pytest.skip("needs a C++ compiler, pkg-config and libfuzzylite-dev")
    folder = tmp_path_factory.mktemp("fuzzylite")
    program = folder / "fuzzylite_oracle"
    flags = subprocess.run(
        ["pkg-config", "--cflags", "--libs", "fuzzylite"], check=True, capture_output=True, text=True
    ).stdout.split()
    source = Path(__file__).with_name("fuzzylite_oracle.cpp")
    subprocess.run([*compiler.split(), "-std=c++17", "-O2", source, "-o", program, *flags], check=True)

    def ask(data, e, ec, resolution):
        (folder / "controller.fll").write_text(to_fll(data))
        lines = "".join(f"{x!r} {y!r}\n" for x, y in zip(e.tolist(), ec.tolist(), strict=True))
        answer = subprocess.run(
            [program, folder / "controller.fll", str(resolution)],
            input=lines, check=True, capture_output=True, text=True, timeout=120,
        )  # fmt: skip
        return np.array(answer.stdout.split(), dtype=float)

    return ask


def compare(fuzzylite, controller, data, e, ec, agreement):
    coarse, resolution = fuzzylite(data, e, ec, 1024), 1024
    while True:
        resolution *= 4
        fine = fuzzylite(data, e, ec, resolution)
        assert np.all(np.isfinite(fine))
        own_error = np.abs(fine - coarse).max()
        if own_error < agreement:
            break
        assert resolution < 100_000, f"fuzzylite does not agree with itself: {own_error}"
        coarse = fine
    ours, _ = fuzzy.infer_batch(controller, e, ec)
    difference = np.abs(ours - fine).max()
    assert difference < own_error, f"|du| = {difference:.1e}, fuzzylite's own error is {own_error:.1e}"


def test_the_whole_grid_of_inputs_agrees_with_fuzzylite(fuzzylite, controller, data):
    # 47 x 41 points from below to above the universes, off the knees; both ends saturate.
    e, ec = (x.ravel() for x in np.meshgrid(np.linspace(-1.13, 1.1, 47), np.linspace(-1.07, 1.2, 41), indexing="ij"))
    compare(fuzzylite, controller, data, e, ec, agreement=2e-6)


def test_the_corner_points_of_all_sets_agree_with_fuzzylite(fuzzylite, controller, data):
    def corners(name):
        points = {x for spec in data[name]["terms"].values() for p in spec.values() for x in p if np.isfinite(x)}
        return sorted(points | {0.0})

    e, ec = (x.ravel() for x in np.meshgrid(corners("E"), corners("EC"), indexing="ij"))
    compare(fuzzylite, controller, data, e, ec, agreement=2e-6)


def test_gaussian_sets_agree_with_fuzzylite(fuzzylite, gaussian_data):
    e, ec = np.random.default_rng(5).uniform(-1.1, 1.1, (2, 300))
    compare(fuzzylite, make_controller(gaussian_data), gaussian_data, e, ec, agreement=2e-6)
