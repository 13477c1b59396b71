"""What Python cannot see of the module: memory that it asks for, and memory that it must not touch.

tests/probes/vision_probe.cpp is built with the release (scripts/build --tests) and once more with
AddressSanitizer and UBSan, in a build folder of its own: some minutes of one core the first time, nothing after that.
"""

import pytest

from build_tree import ROOT, build_sanitized, run

pytestmark = pytest.mark.builds

RELEASE = ROOT / "build" / "release"


def counts_of(output):
    """{key: count} of the probe's lines."""
    return {key: int(count) for key, count in (line.rsplit(" ", 1) for line in output.splitlines())}


def test_an_observer_that_tracks_asks_for_no_memory():
    if not (RELEASE / "build.ninja").exists():
        pytest.skip("needs build/release: run scripts/build --tests")
    run("cmake", "--build", RELEASE, "--target", "vision_probe")  # does nothing if nothing changed
    counts = counts_of(run(RELEASE / "tests" / "probes" / "vision_probe", "allocations"))
    for distance_m in ("0.65", "1.1", "2.44", "5"):
        assert counts[f"tracked_at_{distance_m}_m"] >= 25  # of 30, of which the first is acquired
        assert counts[f"allocations_at_{distance_m}_m"] == 0


def test_hostile_frames_touch_no_foreign_memory():
    # The sanitizers end the program at the first mistake, so that it comes to its end at all is the test. What it
    # prints says that the corpus reached every part: leaders seen and tracked, frames that cannot be read.
    probe = build_sanitized("vision_probe") / "probes" / "vision_probe"
    counts = counts_of(run(probe, "corpus", 1, 2400))
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
