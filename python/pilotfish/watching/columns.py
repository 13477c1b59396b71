"""The columns of ``pilotfish top``: how each is named, shown, coloured, sorted and explained. One list for the screen,
for ``--once`` and for the help."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from pilotfish.watching.robots import Row

NOT_KNOWN = "-"
_STATUS_STYLES = {
    "tracking": "green",
    "coasting": "yellow",
    "searching": "cyan",
    "lost": "magenta",
    "stopped": "bold yellow",
    "invalid_input": "bold red",
    "two coordinators": "bold red",
}
STALE_STYLE, DEAD_STYLE = "bright_black", "red"


@dataclass(frozen=True)
class Column:
    """One column. ``key`` sorts rows: the most interesting last, so that reversing shows it first."""

    name: str
    title: str
    text: Callable[[Row], str]
    key: Callable[[Row], Any]
    help: str
    right: bool = True


def _number(value: float | None, decimals: int, factor: float = 1.0, sign: bool = False) -> str:
    if value is None or not math.isfinite(value):
        return NOT_KNOWN
    return f"{factor * value:{'+' if sign else ''}.{decimals}f}"


def _key(value: float | None) -> float:
    return -math.inf if value is None or not math.isfinite(value) else abs(value)


def _rising_text(row: Row) -> str:
    names = list(row.rising)
    if not names:
        return ""
    return f"{names[0]} +{row.rising[names[0]]}" + (f" (+{len(names) - 1})" if len(names) > 1 else "")


def _leader_text(row: Row) -> str:
    if row.leader_index is None:
        return NOT_KNOWN
    who = "first" if row.leader_index == 0 else f"other {row.leader_index}"  # as the page of view says it
    return who + (f" ({row.leader_changes} changes)" if row.leader_changes else "")


COLUMNS: tuple[Column, ...] = (
    Column("robot", "robot", lambda r: r.robot, lambda r: r.robot, "Name on the bus.", right=False),
    Column("status", "status", lambda r: r.status, lambda r: r.status, "What the coordinator is doing.", right=False),
    Column(
        "age_s",
        "age [s]",
        lambda r: _number(r.age_s, 1),
        lambda r: r.age_s,
        "Of the newest message; grey from 0.5 s, red from 2 s.",
    ),
    Column(
        "distance_m",
        "d [m]",
        lambda r: _number(r.distance_m, 3),
        lambda r: _key(r.distance_m),
        "Measured distance to the leader; - where it is not measured.",
    ),
    Column(
        "bearing_deg",
        "θ [°]",
        lambda r: _number(r.bearing_rad, 1, math.degrees(1.0), sign=True),
        lambda r: _key(r.bearing_rad),
        "Measured bearing of the leader, positive: to the left.",
    ),
    Column(
        "error_m",
        "e [m]",
        lambda r: _number(r.error_m, 3, sign=True),
        lambda r: _key(r.error_m),
        "Distance error, wanted minus measured; positive: too close.",
    ),
    Column(
        "output",
        "u",
        lambda r: _number(r.output, 2, sign=True),
        lambda r: _key(r.output),
        "Output of the fuzzy law, -1 to 1.",
    ),
    Column(
        "linear_mps",
        "v [m/s]",
        lambda r: _number(r.linear_mps, 2, sign=True),
        lambda r: _key(r.linear_mps),
        "Commanded forward speed.",
    ),
    Column(
        "angular_radps",
        "ω [rad/s]",
        lambda r: _number(r.angular_radps, 2, sign=True),
        lambda r: _key(r.angular_radps),
        "Commanded turn rate, positive: to the left.",
    ),
    Column(
        "frame_rate_hz",
        "fps",
        lambda r: _number(r.frame_rate_hz, 1),
        lambda r: _key(r.frame_rate_hz),
        "Frames a second.",
    ),
    Column(
        "latency_ms",
        "lat [ms]",
        lambda r: (
            f"{_number(r.latency_s, 1, 1000)} / {_number(r.latency_max_s, 1, 1000)}"
            if r.latency_s is not None
            else NOT_KNOWN
        ),
        lambda r: _key(r.latency_max_s),
        "From the exposure to the command: median of the last frames / largest of 10 s.",
    ),
    Column("reason", "reason", lambda r: r.reason, lambda r: r.reason, "Why, where it does not track.", right=False),
    Column(
        "rising",
        "refusals",
        _rising_text,
        lambda r: sum(r.rising.values()),
        "The counter that rose most within 10 s, by how much, and how many more rose.",
        right=False,
    ),
    Column(
        "leader",
        "leader",
        _leader_text,
        lambda r: r.leader_changes,
        "Who is followed: first, the configured leader; other 1, the first alternative; and how often that changed.",
        right=False,
    ),
    Column("wheels", "wheels", lambda r: r.wheels or NOT_KNOWN, lambda r: r.wheels, "pilotfish-base.", right=False),
)


GAP = 1  # columns of the screen between two of ours
# Who has least room sees these first, as many as fit.
_BY_IMPORTANCE = (
    *("robot", "status", "age_s", "distance_m", "error_m", "linear_mps", "reason", "rising", "wheels", "frame_rate_hz"),
    *("latency_ms", "bearing_deg", "angular_radps", "output", "leader"),
)


def width(rows: list[Row], columns: Sequence[Column]) -> int:
    """Of a table of these, in characters."""
    return sum(max(len(column.title), *(len(column.text(row)) for row in rows)) + GAP for column in columns) - GAP


def fitting(rows: list[Row], available: int) -> list[Column]:
    """The most important ones that fit side by side, in their usual order; name and status always."""
    by_name = {column.name: column for column in COLUMNS}
    chosen: list[Column] = []
    for name in _BY_IMPORTANCE:
        if len(chosen) < 2 or width(rows, [*chosen, by_name[name]]) <= available:
            chosen.append(by_name[name])
    return [column for column in COLUMNS if column in chosen]


def style(row: Row, column: Column) -> str:
    """A colour in Rich's words; empty: none."""
    if row.freshness != "fresh":
        return DEAD_STYLE if row.freshness == "dead" else STALE_STYLE
    if column.name == "status":
        return _STATUS_STYLES.get(row.status, "")
    if column.name == "rising" and row.rising:
        return "yellow"
    if column.name == "wheels" and row.wheels in ("stopped", "fault", "silent"):
        return "bold red" if row.wheels != "stopped" else "bold yellow"
    return ""


def ordered(rows: list[Row], column: Column, reverse: bool) -> list[Row]:
    """Sorted by the column; robots that are equal in it stay in the order of their names."""
    by_name = sorted(rows, key=lambda row: row.robot)
    return sorted(by_name, key=column.key, reverse=reverse)


def as_dict(row: Row) -> dict[str, Any]:
    """For JSON: SI units, null for what is not known."""
    values = asdict(row)
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value for name, value in values.items()
    } | {"freshness": row.freshness}
