"""The tables that are printed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.box import SIMPLE
from rich.table import Table

from bench.sim.figures import CrowdFigures, LoopFigures
from bench.sim.programs import Programs


def loops(title: str, rows: Sequence[LoopFigures], ratios: Mapping[str, float], harness_per_s: float) -> Table:
    caption = (
        "processor time of one thread; ratio: Pilotfish's frames per second over this one's; errors: RMS of the second "
        f"half, against the truth.\nPilotfish through Python's run_in_process: {harness_per_s:.0f} frames/s"
    )
    headings = (
        "frames/s",
        "ratio",
        "frame, ms",
        "render",
        "see, decide",
        "move",
        "seen",
        "distance, mm",
        "bearing, deg",
    )
    table = _table(title, caption, "loop", headings)
    for row in rows:
        table.add_row(
            row.loop,
            f"{row.frames_per_s:.0f}",
            f"{ratios[row.loop]:.1f}",
            f"{row.frame_ms:.2f}",
            f"{row.render_ms:.2f}",
            f"{row.see_decide_ms:.2f}",
            f"{row.move_ms:.3f}",
            f"{100 * row.seen:.1f} %",
            f"{row.distance_rms_mm:.2f}",
            f"{row.bearing_rms_deg:.3f}",
        )
    return table


def crowds(title: str, rows: Sequence[CrowdFigures]) -> Table:
    caption = (
        "real time: simulated over real time, by the clock; on free processors: the same if processor time were all\n"
        "that counts; per robot: processor time of a picture and of its answer; frame: all robots, by the clock"
    )
    headings = ("threads", "real time", "on free processors", "render, ms", "answer, ms", "frame p50, ms", "p99, ms")
    table = _table(title, caption, "robots", (*headings, "made in, s", "seen", "worst RMS, mm"))
    for row in rows:
        table.add_row(
            f"{row.robots}",
            f"{row.threads}",
            f"{row.real_time_factor:.2f}",
            f"{row.on_free_processors:.2f}",
            f"{row.render_ms:.2f}",
            f"{row.answer_ms:.2f}",
            f"{row.frame_p50_ms:.1f}",
            f"{row.frame_p99_ms:.1f}",
            f"{row.made_s:.2f}",
            f"{100 * row.seen:.1f} %",
            f"{row.worst_rms_mm:.1f}",
        )
    return table


def programs(rows: Sequence[Programs]) -> Table:
    caption = "latency: from a picture's arrival to its command, as the coordinators report it; processors: busy"
    headings = ("exposures", "skipped", "pictures", "answered", "tracked", "p50, ms", "p99, ms", "processors")
    table = _table("real programs on one bus, in real time", caption, "robots", headings)
    for row in rows:
        table.add_row(
            f"{row.robots}",
            f"{row.exposures}",
            f"{row.skipped}",
            f"{row.delivered}",
            f"{row.answered}",
            f"{row.tracked}",
            f"{row.latency_p50_ms:.2f}",
            f"{row.latency_p99_ms:.2f}",
            f"{row.processor_s_per_s:.2f}",
        )
    return table


def _table(title: str, caption: str, first: str, headings: tuple[str, ...]) -> Table:
    table = Table(title=title, title_justify="left", caption=caption, caption_justify="left", box=SIMPLE)
    table.add_column(first, no_wrap=True)
    for heading in headings:
        table.add_column(heading, justify="right")
    return table
