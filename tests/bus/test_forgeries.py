"""A sender that receives everything on the bus but has no key: tests/probes/forgery_probe.cpp."""

import subprocess
from pathlib import Path

import pytest

RELEASE = Path(__file__).parents[2] / "build" / "release"
FORGERIES = 1_000_000


def test_of_a_million_forged_or_replayed_messages_none_is_accepted():
    if not (RELEASE / "build.ninja").exists():
        pytest.skip("needs build/release: run scripts/build --tests")
    subprocess.run(["cmake", "--build", RELEASE, "--target", "forgery_probe"], check=True, capture_output=True)
    probe = RELEASE / "tests" / "probes" / "forgery_probe"
    done = subprocess.run([probe, "8", str(FORGERIES)], check=True, capture_output=True, text=True)
    counts = {key: int(count) for key, count in (line.split() for line in done.stdout.splitlines())}
    accepted, stops = counts.pop("forged_accepted"), counts.pop("forged_stops_accepted")
    genuine, genuine_accepted = counts.pop("genuine"), counts.pop("genuine_accepted")
    assert accepted == 0
    assert sum(counts.values()) == FORGERIES
    assert min(counts.values()) == FORGERIES / len(counts)  # every kind had its share
    # The receiver is no wall: all that was genuine got through, one message in a thousand, in spite of the stops that
    # bits flipped in `run` have made.
    assert genuine_accepted == genuine == FORGERIES / 1000
    assert stops > 0
