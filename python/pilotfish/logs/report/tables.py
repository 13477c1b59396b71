"""Tables of the page. Whatever comes out of a recording is escaped here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape

from pilotfish.logs.notes import STAGE_LIMITS_MS, Settings, Stage
from pilotfish.logs.report.repeats import Repeats, with_repeats_joined
from pilotfish.logs.run import RunEvent
from pilotfish.logs.summary import TITLES, Summary, shown
from pilotfish.reason_words import reason_text
from pilotfish.stage_words import stage_words

MOST_EVENTS = 300


def table(head: Sequence[str], rows: Iterable[Sequence[str]], numbers: bool = True) -> str:
    """Texts, the first column's to the left, the others' to the right if they are ``numbers``."""
    kind, first = ("number", "label") if numbers else ("word", "word")
    tops = "".join(f'<th class="{"word" if at == 0 else kind}">{escape(name)}</th>' for at, name in enumerate(head))
    body = "".join(
        "<tr>"
        + "".join(f'<td class="{first if at == 0 else kind}">{escape(cell)}</td>' for at, cell in enumerate(row))
        + "</tr>\n"
        for row in rows
    )
    return f'<div class="wide"><table><thead><tr>{tops}</tr></thead><tbody>\n{body}</tbody></table></div>'


def summary_table(summaries: Mapping[str, Summary]) -> str:
    """One line a figure, one column a run."""
    rows = []
    for name, (title, unit, _) in TITLES.items():
        label = f"{title} [{unit}]" if unit else title
        rows.append([label, *(shown(name, getattr(summary, name)) for summary in summaries.values())])
    return table(["", *summaries], rows)


def stage_table(stages: Mapping[str, Stage]) -> str:
    """How often each stage took how long."""
    head = ["stage [ms]", *(f"< {limit:g}" for limit in STAGE_LIMITS_MS), f"≥ {STAGE_LIMITS_MS[-1]:g}", "longest"]
    return table(
        head, [[stage_words(name), *map(str, one.counts), f"{one.max_ms:.2f}"] for name, one in stages.items()]
    )


def counter_table(counters: Mapping[str, Mapping[str, int]]) -> str:
    """By run; what was not counted there is nothing."""
    names = sorted({name for own in counters.values() for name in own})
    return table(
        ["counter", *counters], [[name, *(str(own.get(name, 0)) for own in counters.values())] for name in names]
    )


def event_table(events: Sequence[RunEvent]) -> str:
    """The first of them, and how many more there are; what repeats is folded."""
    items = with_repeats_joined(events)
    shown, more = items[:MOST_EVENTS], sum(map(_count, items[MOST_EVENTS:]))
    rows = [_repeats_row(item) if isinstance(item, Repeats) else _event_row(item) for item in shown]
    head = "".join(f'<th class="word">{name}</th>' for name in ("t [s]", "event", "what"))
    body = "\n".join(rows)
    text = f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>\n{body}</tbody></table></div>'
    return text + _more_note(more)


def _event_row(event: RunEvent) -> str:
    return _event_cells(event.t_s, event.kind, escape(event_words(event)))


def _event_cells(t_s: float, kind: str, what: str) -> str:
    """``what`` is HTML."""
    return (
        f'<tr><td class="number">{t_s:.2f}</td><td class="label">{escape(kind)}</td><td class="word">{what}</td></tr>'
    )


def _repeats_row(repeats: Repeats) -> str:
    events = repeats.events
    often = ", ".join(
        f"{event_words(RunEvent(0.0, 'status', text))} {count} {'time' if count == 1 else 'times'}"
        for text, count in repeats.counts
    )
    said = f"{len(events)} changes between {events[0].t_s:.2f} and {events[-1].t_s:.2f} s: {often}"
    each = table(
        ["t [s]", "what"], [[f"{event.t_s:.2f}", event_words(event)] for event in events[:MOST_EVENTS]], numbers=False
    )
    note = _more_note(len(events) - MOST_EVENTS)
    details = f"<details><summary>{escape(said)}</summary>{each}{note}</details>"
    return _event_cells(events[0].t_s, "status", details)


def _count(item: RunEvent | Repeats) -> int:
    return len(item.events) if isinstance(item, Repeats) else 1


def _more_note(more: int) -> str:
    if more <= 0:
        return ""
    return f'<p class="dim">… and {more} more, in <code>pilotfish export --to csv --table events</code></p>'


def event_words(event: RunEvent) -> str:
    """Its text; of a status with the reason in words."""
    status, separator, reason = event.text.partition(": ")
    return f"{status}: {reason_text(reason)}" if event.kind == "status" and separator else event.text


def difference_table(names: Sequence[str], rows: Mapping[str, Sequence[str | None]]) -> str:
    """Keys on which the runs do not agree."""
    shown_rows = [[key, *("–" if value is None else value for value in values)] for key, values in rows.items()]  # noqa: RUF001
    return table(["key", *names], shown_rows, numbers=False)


def settings_texts(settings: Settings) -> str:
    """The recorded files, folded."""
    said = table(["", ""], [["program", settings.program], ["command line", settings.command_line]], numbers=False)
    files = ""
    for file in settings.files:
        summary = f"<summary>{escape(file.role)}: {escape(file.name)}</summary>"
        files += f"<details>{summary}<pre>{escape(file.text)}</pre></details>\n"
    return said + files
