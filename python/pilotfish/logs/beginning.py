"""A recording that begins in the middle of a run: a later file of a ring, or a logger that was started afterwards."""

from __future__ import annotations

from pathlib import Path

from pilotfish.black_box.log import earlier_files, program_start_utime
from pilotfish.logs.run import RobotRun

_OF_A_STRETCH = ("setpoint", "resume", "start", "begin")


def late_text(file: Path, first_utime: int, missing: str) -> str:
    """What is said of it. ``first_utime``: the wall clock where it begins [us]; ``missing``: what was before."""
    start_utime = program_start_utime(file)
    if start_utime is None or start_utime > first_utime:
        return f"the recording begins after the start of the coordinator: {missing} came before"
    left = earlier_files(file)
    beside = f"earlier files ({left[0].name}, ...) are beside it and were not read" if left else ""
    late_s = (first_utime - start_utime) * 1e-6
    return (
        f"the recording begins {late_s:.1f} s after the start of the coordinator: "
        f"{beside or 'earlier files were deleted'}"
    )


def approach_is_missing(run: RobotRun) -> bool:
    """Whether what is recorded last began before the recording did: no start, setpoint or resume is in it."""
    stretches = [event.kind for event in run.events if event.kind in _OF_A_STRETCH]
    return bool(stretches) and stretches[-1] == "begin"


def late_beginnings(run: RobotRun) -> list[str]:
    """What the events say of it, for people."""
    return [event.text for event in run.events if event.kind == "begin" and event.text.startswith("the recording")]
