"""What Python cannot see of the room: memory that it asks for, and memory that it must not touch.

tests/probes/vision_probe.cpp is built with the release (scripts/build says PILOTFISH_TESTS=ON) and once more with
AddressSanitizer and UBSan, in a build folder of its own: some minutes of one core the first time, nothing after that.
"""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
RELEASE, SANITIZED = ROOT / "build" / "release", ROOT / "build" / "asan-probe"
# The preset "asan" of CMakePresets.json, and the probe; -O1 takes no longer to build and a fifth of the time to run.
SANITIZERS = [
    "-DCMAKE_BUILD_TYPE=Debug",
    "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1",
    "-DPILOTFISH_SANITIZE=ON",
    "-DPILOTFISH_PYTHON=OFF",
    "-DPILOTFISH_WERROR=ON",
    "-DPILOTFISH_TESTS=ON",
]


def run(*command):
    done = subprocess.run(list(map(str, command)), check=False, capture_output=True, text=True)
    assert done.returncode == 0, f"{command} failed:\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    return done.stdout


def counts_of(output):
    """{key: count} of the probe's lines."""
    return {key: int(count) for key, count in (line.rsplit(" ", 1) for line in output.splitlines())}


def test_an_observer_that_tracks_asks_for_no_memory():
    if not (RELEASE / "build.ninja").exists():
        pytest.skip("needs build/release: run scripts/build")
    run("cmake", "--build", RELEASE, "--target", "vision_probe")  # does nothing if nothing changed
    counts = counts_of(run(RELEASE / "tests" / "probes" / "vision_probe", "allocations"))
    for distance_m in ("0.65", "1.1", "2.44", "5"):
        assert counts[f"tracked_at_{distance_m}_m"] >= 25  # of 30, of which the first is acquired
        assert counts[f"allocations_at_{distance_m}_m"] == 0


def test_hostile_frames_touch_no_foreign_memory():
    # The sanitizers end the program at the first mistake, so that it comes to its end at all is the test. What it
    # prints says that the corpus reached every part: leaders seen and tracked, frames that cannot be read.
    if not (SANITIZED / "build.ninja").exists():
        run("cmake", "-S", ROOT, "-B", SANITIZED, "-G", "Ninja", *SANITIZERS)
    run("cmake", "--build", SANITIZED, "--target", "vision_probe")
    counts = counts_of(run(SANITIZED / "tests" / "probes" / "vision_probe", "corpus", 1, 2400))
    assert counts["frames"] == 2400
    assert counts["observed"] > 50
    assert counts["tracked"] > 20
    for refusal in (
        "no tag in the picture",
        "the frame has fewer bytes than its size promises",
        "the frame is too large",
        "the frame is too small",
        "the frame's stride is shorter than a row",
        "the leader is farther from where it was than it can have moved",
        "the leader's pose is not credible",
    ):
        assert counts[f"refused: {refusal}"] > 0, refusal
