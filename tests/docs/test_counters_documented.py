"""Every counter that a program can publish stands in a table of the operating guide, and no other."""

import re
from pathlib import Path

from pilotfish import core

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs/operating-guide.md").read_text()

# How a counter gets its name in C++: what the status and the base's state are made from.
NAMED = [
    r"\b(?:count_?|reject|refuse)\(\s*\"(\w+)\"",
    r"\b(?:refused|counters_?)\[\"(\w+)\"",
    r"\brefused\[[^]\"]*\? \"(\w+)\" : \"\w+\"\]",
    r"\brefused\[[^]\"]*\? \"\w+\" : \"(\w+)\"\]",
    r"\b(?:repaired|rejection|refusal) = \"(\w+)\"",
    r"std::pair\{\"(\w+)\", (?:rejected_|odometry_)",
    r"\"((?:fragment|message)_\w+)\"",  # of src/bus/reassembly.cpp, which returns them
    r"case (?:Command|Latch)Verdict::\w+: return \"(\w+)\"",
]
VISION = ROOT / "include/pilotfish/vision/rejection_counters.hpp"
NEVER_COUNTED = {"command_accepted", "stopped", "resumed", "already_running"}


def published() -> set[str]:
    sources = [file for folder in ("src/bus", "src/base", "apps") for file in (ROOT / folder).rglob("*.cpp")]
    names = {name for file in sources for pattern in NAMED for name in re.findall(pattern, file.read_text())}
    names |= {verdict.counted_as for verdict in (core.SetpointVerdict.wrong_session, core.SetpointVerdict.replayed)}
    names |= set(re.findall(r'^  X\(\w+, "(\w+)", \w+,', VISION.read_text(), re.MULTILINE))
    return names - NEVER_COUNTED


def documented() -> set[str]:
    """The names in the first column of the tables whose head begins with "counter"."""
    tables = re.findall(r"^\| counter.*\n\|---.*\n((?:\|.*\n)+)", GUIDE, re.MULTILINE)
    assert len(tables) == 2
    return {
        name for table in tables for row in table.splitlines() for name in re.findall(r"`(\w+)`", row.split("|")[1])
    }


def test_every_counter_that_can_be_published_is_named_in_the_guide_and_no_other():
    assert {"frames_repeated", "frames_frozen", "tag_hamming", "setpoint_replayed", "serial_lost"} <= published()
    assert documented() - {"others"} == published()
