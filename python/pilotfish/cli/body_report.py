"""What is said about a learned body: on the console, and at the top of its file."""

from __future__ import annotations

import math

from rich.box import SIMPLE_HEAD
from rich.table import Table

from pilotfish.calibration.body import Collected, LearnedBody
from pilotfish.cli.console import console, warn


def remarks(film_name: str, learned: LearnedBody) -> list[str]:
    """The comments above a learned leader: from what, and how well."""
    whence = "the turning axis" if learned.turning else f"tag {learned.reference_id}, whose place was measured"
    return [
        f"Learned by `pilotfish learn-body` from {learned.frames_used} frames of {film_name};",
        f"base frame from {whence}.",
        f"Reprojection error {learned.rms_px:.3f} px RMS. One standard deviation of each tag's place:",
        *(
            f"  tag {tag.id}: {tag.position_sigma_m * 1e3:.1f} mm, {math.degrees(tag.rotation_sigma_rad):.2f} deg"
            for tag in learned.tags
        ),
    ]


def print_report(collected: Collected, learned: LearnedBody) -> None:
    """The table of the tags, one line about the film, and the warnings."""
    title = f"{learned.body.name}: {len(learned.tags)} tags, known to one standard deviation (±)"
    table = Table(title=title, box=SIMPLE_HEAD, padding=0)
    for column in ("tag", "used", "left out", "forward", "left", "up m", "± mm", "facing", "tilt", "roll °", "± °"):
        table.add_column(column, justify="right")
    for tag, known in zip(learned.body.tags, learned.tags, strict=True):
        turn = (tag.facing_rad, tag.tilt_rad, tag.roll_rad)
        table.add_row(
            *(str(tag.id), str(known.used), str(known.dropped)),
            *(f"{value + 0.0:.4f}" for value in tag.position_m),
            f"{known.position_sigma_m * 1e3:.1f}",
            *(f"{math.degrees(value) + 0.0:.2f}" for value in turn),
            f"{math.degrees(known.rotation_sigma_rad):.2f}",
        )
    console.print(table)
    said = (
        f"{collected.frames_read} frames read, {learned.frames_used} used; reprojection error {learned.rms_px:.3f} px"
    )
    if learned.turning and learned.turned_rad:
        axis = learned.turning
        said += (
            f"; turned by {math.degrees(learned.turned_rad):.0f} degrees, its centre within "
            f"{axis.wander_m * 1e3:.1f} mm, its axis within {math.degrees(axis.wobble_rad):.2f} degrees (RMS)"
        )
    console.print(said, soft_wrap=True)
    warnings = list(learned.warnings)
    if collected.frames_undecodable:
        warnings.append(f"{collected.frames_undecodable} frames could not be decoded")
    if collected.rare_ids:
        warnings.append(f"ids {list(collected.rare_ids)} were seen once or twice and are taken for misreadings")
    for warning in warnings:
        warn(warning)
