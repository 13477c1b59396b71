"""Plays tests/probes/coordinator_parts_probe.cpp: the sender of commands, the inbox and the simulated clock, alone."""

from __future__ import annotations

import subprocess
from dataclasses import dataclass

from build_tree import built
from pilotfish.core import Reason, Status

SESSION = 77


@dataclass
class Sent:
    counter: int
    utime: int
    linear_mps: float
    status: Status
    reason: Reason
    session: int
    base_session: int
    simulated: bool
    since_answer_us: int
    valid_after_answer_us: int  # 0: no validity is stated


@dataclass
class Recorded:
    counter: int
    holding: bool
    run: bool
    status: Status
    reason: Reason
    missing: Reason
    asked_later_us: int  # than when it was recorded


def play(*lines: str) -> list[tuple[str, object]]:
    """What came out, in order: ("sent", Sent), ("recorded", Recorded), others as lists of words."""
    done = subprocess.run(
        [built("coordinator_parts_probe")], input="\n".join(lines), capture_output=True, text=True, check=True
    )
    happened: list[tuple[str, object]] = []
    for line in done.stdout.splitlines():
        what, *words = line.split()
        if what == "sent":
            counter, utime, linear, status, reason, session, base, simulated, since, valid = words
            happened.append(
                (
                    what,
                    Sent(
                        int(counter),
                        int(utime),
                        float(linear),
                        Status(int(status)),
                        Reason(int(reason)),
                        int(session),
                        int(base),
                        simulated == "1",
                        int(since),
                        int(valid),
                    ),
                )
            )
        elif what == "recorded":
            counter, holding, run, status, reason, missing, asked = words
            happened.append(
                (
                    what,
                    Recorded(
                        int(counter),
                        holding == "1",
                        run == "1",
                        Status(int(status)),
                        Reason(int(reason)),
                        Reason(int(missing)),
                        int(asked),
                    ),
                )
            )
        else:
            happened.append((what, words))
    return happened


def only(happened: list[tuple[str, object]], what: str) -> list:
    return [value for said, value in happened if said == what]
