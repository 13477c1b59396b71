"""The format of a campaign's file as text, made from the tables by which it is checked."""

from __future__ import annotations

import math

from pilotfish.sweep.campaign import NUMBERS, TEXTS
from pilotfish.sweep.keys import MEASUREMENTS, ROOTS
from pilotfish.sweep.metrics import METRICS, OUTCOMES

FORMS = {
    "KEY: [VALUE, ...]": "these values; listed factors are crossed with each other",
    "KEY: {from: A, to: B, steps: N}": "N values at equal distances; scale: log, at equal ratios",
    "NAME: {levels: {LEVEL: {KEY: VALUE}}}": "named sets of keys, as cameras or robots; {} leaves everything as it is",
    "KEY: {uniform: [A, B]}": "sampled; so are the next two, each sample with every combination of listed values",
    "KEY: {log_uniform: [A, B]}": "sampled, its logarithm uniform",
    "KEY: {normal: [MEAN, SIGMA]}": "sampled, cut at within: [A, B], by default 4 sigma from the mean",
}


def describe() -> str:
    """Markdown: every key of a campaign's file with its range, forms of factors, figures, outcomes."""
    lines = [
        "# A campaign's file",
        "",
        "YAML, read by `pilotfish sweep FILE`. Unknown keys are errors. Files are beside this one, or shipped ones",
        "(`hardware/nonideal.yaml`).",
        "",
        *_table("key", "meaning", TEXTS),
        *(f"| `{name}` | {_range(name)}{key.text} |" for name, key in NUMBERS.items()),
        "",
        "## Keys below `set` and `factors`",
        "",
        "Every key of a scenario and of a coordinator's configuration, by the names, units and ranges they have there;",
        "an angle `x_rad` may be written `x_deg`. Elements of lists have numbers:",
        "`robots.leader.trajectory.points.0.x_m`. A key without an effect is an error.",
        "",
        *_table("key", "what it sets", ROOTS),
        "",
        "Drawn measurements. The sigmas are by default those of rendered pictures of 640 x 480 at f = 600 px, times",
        "600 px / f; the view is the calibration's, less half a tag. All robots measure as `robot` does.",
        "",
        *_table(
            "key",
            "meaning",
            {f"measurements.{k}": f"{v.low:g} to {v.high:g}: {v.text}" for k, v in MEASUREMENTS.items()},
        ),
        "",
        "## Factors",
        "",
        *_table("form", "values", FORMS),
        "",
        "## Figures",
        "",
        "Of the true distance, bearing and command of `robot`:",
        "",
        *_table("metric", "meaning", {m.name: f"{m.text} [{m.unit}]" for m in METRICS.values()}),
        "",
        "## Outcomes",
        "",
        *_table("outcome", "meaning", OUTCOMES),
    ]
    return "\n".join(lines) + "\n"


def _table(left: str, right: str, rows: dict[str, str]) -> list[str]:
    return [f"| {left} | {right} |", "|---|---|", *(f"| `{key}` | {text} |" for key, text in rows.items())]


def _range(name: str) -> str:
    key = NUMBERS[name]
    default = "" if math.isnan(key.default) else f", default {key.default:g}"
    return f"{key.low:g} to {key.high:.10g}{default}: "
