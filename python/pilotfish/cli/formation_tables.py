"""The tables of ``pilotfish formation``."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.table import Table

from pilotfish.formation.expand import tag_offsets
from pilotfish.formation.file import Formation
from pilotfish.formation.gaps import GOAL_M, GOAL_RAD, Gaps
from pilotfish.formation.measures import Forming, Keeping
from pilotfish.formation.run import FormationRun
from pilotfish.formation.stability import Stability, Trial
from pilotfish.law_names import law_name
from pilotfish.number_text import signed


def watches_table(formation: Formation) -> list[Table]:
    """One table for each shape: who watches whom, the setpoint, where it stands, which tags it wears."""
    offsets, ids = tag_offsets(formation), sorted(tag.id for tag in formation.outlook.body.tags)
    tables = []
    for stage in formation.stages:
        when = "at the start" if stage.at_s == 0.0 else f"from {stage.at_s:g} s, within {stage.over_s:g} s"
        table = _table(f"{stage.shape.name.replace('_', ' ')} {when}")
        for column in ("robot", "watches", "d_p m", "theta_pd °", "ahead m", "left m", "tags"):
            table.add_column(column, justify="left" if column in ("robot", "watches", "tags") else "right")
        for robot, (x_m, y_m) in stage.places.items():
            watch = stage.watches.get(robot)
            kept = (
                (watch.leader, f"{watch.distance_m:.3f}", signed(math.degrees(watch.bearing_rad), 1))
                if watch
                else ("-", "-", "-")
            )
            tags = ", ".join(str(each + offsets[robot]) for each in ids)
            table.add_row(robot, *kept, signed(x_m, 2), signed(y_m, 2), tags)
        tables.append(table)
    return tables


def keeping_table(results: Sequence[Keeping], title: str) -> Table:
    """One row a robot."""
    table = _table(
        title,
        "Over the last quarter of the last shape. e = d_p - d, positive: too close.\n"
        "Place: how far it is from its place behind the leader in front, which a robot\n"
        "reaches once all look the same way; on a curve not zero.",
    )
    columns = ("robot", "leader", "d_p m", "mean e mm", "max |e|", "bearing °", "max", "place mm", "seen %")
    for column in columns:
        table.add_column(column, justify="left" if column in ("robot", "leader") else "right")
    for k in results:
        table.add_row(
            k.robot,
            k.leader,
            f"{k.distance_setpoint_m:.2f}",
            *_errors(k),
            f"{1000.0 * k.place_error_m:.0f}",
            f"{100.0 * k.seen_ratio:.0f}",
        )
    return table


def followed_table(run: FormationRun) -> Table | None:
    """One row a change of leader; None if there was none."""
    changes = [
        (at_s, robot, before, leader)
        for robot, since in run.followed.items()
        for (_, before), (at_s, leader) in itertools.pairwise(since)
    ]
    if not changes:
        return None
    table = _table("Who took another leader")
    for column in ("at s", "robot", "from", "to"):
        table.add_column(column, justify="right" if column == "at s" else "left")
    for at_s, robot, before, leader in sorted(changes):
        table.add_row(f"{at_s:.2f}", robot, before, leader)
    return table


def otherwise_table(formation: Formation) -> Table | None:
    """One row for each robot that is followed while another one is lost; None if there is none."""
    otherwise = formation.otherwise
    if not otherwise.watches:
        return None
    back = f", back after {otherwise.back_after_s:g} s" if otherwise.back_after_s else ""
    table = _table(f"while the leader is lost: after {otherwise.after_lost_s:g} s{back}")
    for column in ("robot", "watches", "d_p m", "theta_pd °"):
        table.add_column(column, justify="left" if column in ("robot", "watches") else "right")
    for robot, watches in otherwise.watches.items():
        for watch in watches:
            kept = f"{watch.distance_m:.3f}", signed(math.degrees(watch.bearing_rad), 1)
            table.add_row(robot, watch.leader, *kept)
    return table


def forming_table(results: Sequence[Forming], tolerance_m: float) -> Table:
    """One row for the start and each change."""
    table = _table(
        f"Forming: until every robot is within {1000.0 * tolerance_m:g} mm for good",
        "Along (|e|) and across (d_p |theta - theta_pd|) its line of sight, until the next\nchange.",
    )
    for column in ("from s", "shape", "formed after s", "least distance m", "between"):
        table.add_column(column, justify="left" if column in ("shape", "between") else "right")
    for each in results:
        after = "[red]never[/]" if each.formed_after_s is None else f"{each.formed_after_s:.1f}"
        shape = each.shape.replace("_", " ")
        table.add_row(f"{each.at_s:g}", shape, after, f"{each.least_apart_m:.3f}", " and ".join(each.nearest))
    return table


def stability_tables(results: Sequence[Stability], trial: Trial) -> list[Table]:
    """Gains over the frequency, and a summary."""
    many = len({result.headway_s for result in results}) > 1
    names = [_name(result, many) for result in results]
    gains = _table(
        "Greatest gain from robot to robot",
        "-: lost, or below 1 % of the leader's amplitude.",
    )
    gains.add_column("Hz", justify="right")
    for name in names:
        gains.add_column(name, justify="right")
    for row, frequency_hz in enumerate(trial.frequencies_hz):
        gains.add_row(f"{frequency_hz:g}", *(_gain(_nanmax(result.gain[row])) for result in results))
    peaks = _table(
        f"A chain of {trial.robots}: {trial.speed_mps:g} ± {trial.amplitude_mps:g} m/s, {trial.spacing_m:g} m apart",
        "Stable: no gain above 1.01. Through: peak gain from the leader to the last robot.\n"
        "Step: from speed - amplitude to speed + amplitude; greatest distance errors.",
    )
    for column in ("", "peak gain", "at Hz", "stable", "through", "step: first mm", "last mm", "ratio"):
        peaks.add_column(column, justify="right" if column else "left", no_wrap=not column)
    for name, result in zip(names, results, strict=True):
        error_m = result.step.peak_error_m
        stable = "yes" if result.string_stable else "[red]no[/]"
        first, last = 1000.0 * error_m[0], 1000.0 * error_m[-1]
        peak = (_gain(result.peak_gain), f"{result.peak_at_hz:g}", stable, _gain(result.peak_from_leader[-1]))
        peaks.add_row(name, *peak, f"{first:.1f}", f"{last:.1f}", f"{last / first:.2f}")
    return [gains, peaks]


def gaps_table(results: Sequence[Gaps]) -> Table:
    """One row a robot, the paths side by side."""
    law = law_name(results[0].law)
    goal = f"{1000.0 * GOAL_M:g} mm and {math.degrees(GOAL_RAD):g}°"
    reached = ", ".join(f"{r.path.replace('_', ' ')} {'reached' if r.reached else '[red]missed[/]'}" for r in results)
    nearest = ", ".join(f"{r.least_apart_m:.2f} m" for r in results)
    table = _table(
        f"{law}: steady errors of every robot relative to its leader",
        f"Goal at every moment, {goal}: {reached}.\nLeast distance of any two robots: {nearest}.",
    )
    table.add_column("robot")
    for result in results:
        name = result.path.replace("_", " ")
        for column in (f"{name}\nmean e mm", "\nmax |e|", "\nbearing °", "\nmax"):
            table.add_column(column, justify="right")
    for rows in zip(*(result.keeping for result in results), strict=True):
        table.add_row(rows[0].robot, *(text for each in rows for text in _errors(each)))
    return table


def _errors(k: Keeping) -> tuple[str, str, str, str]:
    return (
        signed(1000.0 * k.mean_error_m, 2),
        f"{1000.0 * k.max_error_m:.2f}",
        signed(math.degrees(k.mean_bearing_error_rad), 2),
        f"{math.degrees(k.max_bearing_error_rad):.2f}",
    )


def _name(result: Stability, many: bool) -> str:
    return f"{law_name(result.law)}{f', {result.headway_s:g} s' if many else ''}"


def _gain(value: float) -> str:
    return f"{value:.3f}" if np.isfinite(value) else "-"


def _nanmax(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else float("nan")


def _table(title: str, caption: str | None = None) -> Table:
    return Table(
        title=title,
        title_justify="left",
        caption=caption,
        caption_justify="left",
        box=SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
    )
