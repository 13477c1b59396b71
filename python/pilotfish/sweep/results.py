"""What a campaign has found so far, by column."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish.data import did_you_mean
from pilotfish.errors import ConfigError, UsageError
from pilotfish.sweep.metrics import DIED, ERROR, METRICS, OK
from pilotfish.sweep.store import Say, read_identity, read_rows

FAILED = "failed_percent"
_FAILED_TEXT = "runs that collided, lost the leader or could not be simulated"
_SHOWN = 12
_UNITS = {
    "_mps": "m/s",
    "_mps2": "m/s²",
    "_mps3": "m/s³",
    "_radps": "rad/s",
    "_radps2": "rad/s²",
    "_per_s": "1/s",
    "_per_m": "1/m",
    "_hz": "Hz",
    "_px": "px",
    "_rad": "rad",
    "_deg": "°",
    "_s": "s",
    "_m": "m",
}


@dataclass(frozen=True)
class Results:
    """One array a column, all of shape (N,), in the order of the runs. Numbers are float64, missing ones NaN."""

    identity: dict[str, Any]
    columns: dict[str, np.ndarray]

    def __len__(self) -> int:
        return len(self.columns["run"])

    @property
    def factors(self) -> dict[str, dict[str, Any]]:
        """What was varied, as campaign.json has it."""
        return self.identity["factors"]

    @property
    def metrics(self) -> list[str]:
        """Figures there are, FAILED among them."""
        return [*self.identity["metrics"], FAILED]

    def outcomes(self) -> Counter[str]:
        """How many runs came out how."""
        return Counter(self.columns["outcome"].tolist())

    def metric(self, name: str) -> np.ndarray:
        """A figure of each run, NaN where there is none."""
        if name == FAILED:
            return np.where(self.columns["outcome"] == OK, 0.0, 100.0)
        if name not in self.identity["metrics"]:
            near = did_you_mean(name, self.metrics)
            raise UsageError(f"--metric: no figure '{name}'{near}; there are: {', '.join(self.metrics)}")
        return self.columns[name]

    def check_has(self, metric: str) -> None:
        """ConfigError says why, if no run has the figure."""
        if not np.isfinite(self.metric(metric)).any():
            raise ConfigError(self.missing(metric))

    def missing(self, metric: str) -> str:
        """Why no run has the figure: how the runs came out, how long they are, what the figure wants."""
        outcomes = ", ".join(f"{count} {name}" for name, count in self.outcomes().most_common())
        said = f"no run has {metric} (of {len(self)}: {outcomes})"
        simulated = sum(count for name, count in self.outcomes().items() if name not in (ERROR, DIED))
        if not simulated:
            return f"{said}: none could be simulated; `pilotfish sweep report` says why"
        why = METRICS[metric].missing
        duration_s = self.identity.get("duration_s")
        lasted = f"; these last {duration_s:g} s (duration_s of the campaign)" if duration_s is not None else ""
        return f"{said}: {why}{lasted}" if why else said

    def factor(self, name: str) -> tuple[str, np.ndarray]:
        """(what it is called, each run's value): of a factor, or of a key that a factor's levels set. The end of a
        name is enough where only one ends so ("speed_mps")."""
        known = {each: self.columns[each] for each in self.factors}
        for each, said in self.factors.items():
            keys = dict.fromkeys(key for level in said.get("levels", {}).values() for key in level)
            for key in keys:
                values = {level: settings.get(key) for level, settings in said["levels"].items()}
                known[f"{each}.{key}"] = _array([values[str(level)] for level in self.columns[each]])
        if name in known:
            return name, known[name]
        ends = [each for each in known if each.endswith(f".{name}")]
        if not ends:  # of a factor of levels: its name, and the end of the key
            head, _, tail = name.partition(".")
            ends = [each for each in known if tail and each.startswith(f"{head}.") and each.endswith(f".{tail}")]
        if len(ends) == 1:
            return ends[0], known[ends[0]]
        if ends:
            raise UsageError(f"'{name}' may be any of: {', '.join(ends)}")
        raise UsageError(f"no factor '{name}'{did_you_mean(name, known)}; there are: {', '.join(known)}")

    def where(self, conditions: Sequence[str]) -> Results:
        """Only the runs for which each "NAME=VALUE" holds; NAME as in factor(). UsageError lists the values there are,
        if none has this one."""
        mask = np.full(len(self), True)
        for condition in conditions:
            name, equals, text = condition.partition("=")
            if not equals:
                raise UsageError(f"--where {condition}: FACTOR=VALUE is wanted")
            name, values = self.factor(name)
            if values.dtype.kind in "fi":
                hits = np.isclose(values, _number(text, condition), rtol=1e-9, atol=0.0)
            else:
                hits = values == text
            if not hits.any():
                there = list(dict.fromkeys(str(value) for value in values.tolist()))
                more = f" and {len(there) - _SHOWN} more" if len(there) > _SHOWN else ""
                raise UsageError(f"--where {condition}: no run has this; {name} is {', '.join(there[:_SHOWN])}{more}")
            mask &= hits
        if not mask.any():
            raise UsageError(f"no run has all of --where {', '.join(conditions)}")
        return Results(self.identity, {name: values[mask] for name, values in self.columns.items()})


def _number(text: str, condition: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise UsageError(f"--where {condition}: '{text}' is not a number") from None


def load_results(out: Path, say: Say | None = None) -> Results:
    """All rows that are there by now; the campaign may still be running. ``say`` gets what to warn of."""
    table, identity = read_rows(out, say), read_identity(out)
    columns = {name: table[name].to_pylist() for name in table.column_names}
    figures = set(identity["metrics"])
    return Results(
        identity,
        {name: _numbers(values) if name in figures else _array(values) for name, values in columns.items()},
    )


def _numbers(values: list[Any]) -> np.ndarray:
    """Of a figure, which is a number even where no run has it."""
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def _array(values: list[Any]) -> np.ndarray:
    there = [value for value in values if value is not None]
    if any(isinstance(value, str) for value in there) or not there:
        return np.array(["none" if value is None else str(value) for value in values], dtype=np.str_)
    if all(isinstance(value, bool) for value in there):
        return np.array([str(value).lower() for value in values], dtype=np.str_)
    if len(there) == len(values) and all(isinstance(value, int) for value in there):
        return np.array(values, dtype=np.int64)
    return _numbers(values)


def metric_label(name: str) -> str:
    """Text and unit of a figure, for an axis."""
    if name == FAILED:
        return "failed runs [%]"
    metric = METRICS[name]
    return f"{metric.text.split(',')[0].split(';')[0]} [{metric.unit}]"


def metric_text(name: str) -> str:
    """What a figure is, in full."""
    return _FAILED_TEXT if name == FAILED else METRICS[name].text


def factor_label(name: str) -> str:
    """The end of a key in words, and its unit: "leader trajectory speed [m/s]"."""
    words = name.split(".")
    last = words[-1]
    suffix = max((suffix for suffix in _UNITS if last.endswith(suffix)), key=len, default="")
    plain = last.removesuffix(suffix).replace("_", " ")
    owner = [word for word in words[:-1] if word not in ("robots", "config", "control")]
    return f"{' '.join([*owner, plain])} [{_UNITS.get(suffix, '-')}]"
