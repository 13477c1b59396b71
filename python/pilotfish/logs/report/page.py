"""The page, section by section."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from html import escape

from pilotfish.logs.beginning import approach_is_missing, late_beginnings
from pilotfish.logs.report.look import CSS
from pilotfish.logs.report.tables import (
    counter_table,
    difference_table,
    event_table,
    settings_texts,
    stage_table,
    summary_table,
)
from pilotfish.logs.report.tiles import doubts_of, tiles
from pilotfish.logs.run import RobotRun, Run
from pilotfish.logs.same_run import same_runs
from pilotfish.logs.settings_keys import differences
from pilotfish.logs.summary import summarize
from pilotfish.plots.inline_svg import inline_svg
from pilotfish.plots.relative_view import draw_relative_view
from pilotfish.plots.run_overview import draw_run_overview
from pilotfish.plots.style import ON_PAGE

# Nothing may be loaded, whatever a recording has put into the page.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


@dataclass(frozen=True)
class ReportedRun:
    """One robot of one recording; ``name`` tells it from the others on the page. It has at least one frame."""

    name: str
    recording: Run
    robot: RobotRun


def report_html(runs: Sequence[ReportedRun]) -> str:
    """The whole page as text."""
    robots = {run.name: run.robot for run in runs}
    title = " and ".join(robots) if len(runs) <= 2 else f"{len(runs)} runs"
    sections = [
        ("Summary", summary_section(runs)),
        ("Figures", _figures(robots)),
        *([("What differs", _differences(robots))] if len(runs) > 1 else []),
        ("Events", _each(robots, lambda robot: event_table(robot.events) if robot.events else _nothing("no event"))),
        ("Timings", _each(robots, _timings)),
        ("Counters", _counters(robots)),
        ("Settings", _each(robots, _settings)),
    ]
    links = "".join(f'<a href="#s{at}">{escape(name)}</a>' for at, (name, _) in enumerate(sections))
    body = "\n".join(f'<h2 id="s{at}">{escape(name)}</h2>\n{text}' for at, (name, text) in enumerate(sections))
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<title>{escape(title)}: Pilotfish report</title><link rel="icon" href="data:,">\n'
        f"<style>{CSS}</style></head>\n"
        f"<body><h1>{escape(title)}</h1>\n<nav>{links}</nav>\n{body}\n</body></html>\n"
    )


def summary_section(runs: Sequence[ReportedRun]) -> str:
    """Where they come from, their figures, and what must be known to read them."""
    summaries = {run.name: summarize(run.robot) for run in runs}
    parts = [f'<p class="dim">{escape(_recorded(run))}</p>' for run in runs]
    if len(runs) == 1:
        parts.append(tiles(runs[0].recording, runs[0].robot, summaries[runs[0].name]))
    parts.append(summary_table(summaries))
    parts.append(
        '<p class="dim">Errors are those that the coordinator measured by its own camera; what the camera cannot see '
        "(a wrong calibration, a wrong mounting) is not in them. After the approach: the last quarter of the part that "
        "begins with the last setpoint, start or resume, as in the experiments.</p>"
    )
    parts += [f'<p class="dim">{escape(pair.text)}</p>' for pair in same_runs({run.name: run.robot for run in runs})]
    parts += [
        f'<p class="dim">{escape(run.name)}: {escape(text)}.</p>'
        for run in runs
        if not approach_is_missing(run.robot)  # else it is among the doubts
        for text in late_beginnings(run.robot)
    ]
    for run in runs:
        doubts = doubts_of(run.recording, run.robot, summaries[run.name])
        parts += [f'<p class="warning">{escape(run.name)}: {escape(doubt)}.</p>' for doubt in doubts.values()]
    for run in runs:
        parts += [f'<p class="warning">{escape(run.name)}: {escape(text)}</p>' for text in _troubles(run.recording)]
    return "\n".join(parts)


def _recorded(run: ReportedRun) -> str:
    """Who, when and by what: where the figures come from."""
    frames, settings = run.robot.frames, run.robot.last_settings
    starts = len(run.robot.sessions)
    parts = [
        f"{run.robot.name}, first picture {_date(int(frames['log_utime_us'][0]))}",
        *(["time was a simulator's"] if run.robot.simulated else []),
        *([f"{starts} starts of the program"] if starts > 1 else []),
        settings.program.partition(",")[0] if settings is not None else "settings not recorded",
        str(run.recording.path),
    ]
    return f"{run.name}: {'; '.join(part for part in parts if part)}"


def _date(utime: int) -> str:
    try:
        return f"{datetime.fromtimestamp(utime * 1e-6, tz=timezone.utc):%Y-%m-%d %H:%M:%S} UTC"
    except (ValueError, OverflowError, OSError):  # whatever a damaged file says
        return "at no date that can be"


def _troubles(run: Run) -> list[str]:
    troubles = list(run.losses[:10])
    if len(run.losses) > 10:
        troubles.append(f"{len(run.losses) - 10} more damaged places")
    if run.unreadable:
        troubles.append(f"{run.unreadable} events that are no messages of this version of Pilotfish")
    return troubles


def _figures(robots: dict[str, RobotRun]) -> str:
    overview = inline_svg(draw_run_overview(robots, theme=ON_PAGE), "overview")
    view = inline_svg(draw_relative_view(robots, theme=ON_PAGE), "view")
    over_time = (
        "Over time. Lines are broken where nothing was measured. Above, the area of a colour is its share of the time: "
        "what is too short to be seen is among the events. Hatched: no messages were recorded, for as long as it says "
        "where there is room."
    )
    return (
        f"<figure>{overview}<figcaption>{over_time}</figcaption></figure>\n"
        f'<figure class="small">{view}'
        "<figcaption>The leader as seen from above, relative to the robot.</figcaption></figure>"
    )


def _differences(robots: dict[str, RobotRun]) -> str:
    known = {name: robot.last_settings for name, robot in robots.items() if robot.last_settings is not None}
    unknown = [name for name in robots if name not in known]
    parts = []
    if unknown:
        parts.append(_nothing(f"not recorded (only a black box records settings): {', '.join(unknown)}"))
    if len(known) > 1:
        rows = differences(known)
        same = "the same program, and the same value of every key"
        parts.append(difference_table(list(known), rows) if rows else _nothing(same))
    return "\n".join(parts)


def _timings(robot: RobotRun) -> str:
    return stage_table(robot.stages) if robot.stages else _nothing("no status with the stages' times was recorded")


def _counters(robots: dict[str, RobotRun]) -> str:
    counters = {name: robot.counters for name, robot in robots.items()}
    return counter_table(counters) if any(counters.values()) else _nothing("nothing was refused, nothing was lost")


def _settings(robot: RobotRun) -> str:
    if not robot.settings:
        return _nothing("not recorded: only a black box records settings")
    return "\n".join(settings_texts(settings) for settings in robot.settings)


def _each(robots: dict[str, RobotRun], section: Callable[[RobotRun], str]) -> str:
    if len(robots) == 1:
        return section(next(iter(robots.values())))
    return "\n".join(f"<h3>{escape(name)}</h3>\n{section(robot)}" for name, robot in robots.items())


def _nothing(text: str) -> str:
    return f'<p class="dim">{escape(text)}</p>'
