"""What a run of a scenario gives, however it was run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pilotfish.harness.frame_report import FrameReport
from pilotfish.recording import Recording

OnProgress = Callable[[int, int], None]  # frames done, frames in all


@dataclass(frozen=True)
class Run:
    """By robot: its recording, and what its coordinator reported about each frame it was given."""

    recordings: dict[str, Recording]
    reports: dict[str, list[FrameReport]]


def measured(reports: list[FrameReport]) -> dict[int, tuple[float, float, float]]:
    """(distance_m, bearing_rad, heading_rad) by utime, of the frames in which the leader was measured."""
    return {
        report.utime: (report.distance_m, report.bearing_rad, report.heading_rad)
        for report in reports
        if report.distance_m is not None and report.bearing_rad is not None and report.heading_rad is not None
    }
