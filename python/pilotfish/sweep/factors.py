"""What a campaign varies: listed values, named levels of several keys, and distributions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from pilotfish.data import did_you_mean
from pilotfish.errors import ConfigError

Value = float | int | str | bool | None
MAX_STEPS = 10_000


@dataclass(frozen=True)
class Factor:
    """A column of the results. ``key`` is what it sets; a factor of levels has none, and sets several."""

    name: str
    key: str | None


@dataclass(frozen=True)
class Listed(Factor):
    """Values that are crossed with those of the other listed factors."""

    values: tuple[Value, ...]


@dataclass(frozen=True)
class Levels(Factor):
    """Named sets of keys, crossed likewise: a camera, a robot."""

    levels: Mapping[str, Mapping[str, Value]]

    @property
    def values(self) -> tuple[str, ...]:
        """The names."""
        return tuple(self.levels)


@dataclass(frozen=True)
class Distributed(Factor):
    """Values that are sampled. ``low`` and ``high`` bound them; mean and sigma are a normal's, before it is cut."""

    kind: str  # "uniform", "log_uniform", "normal"
    low: float
    high: float
    mean: float = 0.0
    sigma: float = 1.0

    def at(self, quantiles: np.ndarray) -> np.ndarray:
        """The values at quantiles in [0, 1], shape (N,): the inverse of the cumulative distribution.

        A normal X cut to [a, b] has F(x) = (Phi(z(x)) - Phi(z(a))) / (Phi(z(b)) - Phi(z(a))), z(x) = (x - mean) /
        sigma, so x = mean + sigma Phi^-1(Phi(z(a)) + q (Phi(z(b)) - Phi(z(a))))."""
        if self.kind == "uniform":
            values = self.low + quantiles * (self.high - self.low)
        elif self.kind == "log_uniform":
            values = np.exp(math.log(self.low) + quantiles * (math.log(self.high) - math.log(self.low)))
        else:
            below, above = ndtr((np.array([self.low, self.high]) - self.mean) / self.sigma)
            values = self.mean + self.sigma * ndtri(below + quantiles * (above - below))
        return np.clip(values, self.low, self.high)


_FORMS = ("[VALUE, ...]", "from/to/steps", "uniform", "log_uniform", "normal", "levels")


def read_factor(name: str, said: Any) -> Factor:
    """As a campaign's file says it. ConfigError with what is wrong, and not with the name."""
    if isinstance(said, list):
        return Listed(name, name, _values(said))
    if not isinstance(said, dict) or not said:
        raise ConfigError(f"{said!r} is none of {', '.join(_FORMS)}; a single value belongs below `set:`")
    if "levels" in said:
        return _levels(name, said)
    if "from" in said or "to" in said or "steps" in said:
        return _steps(name, said)
    kinds = [kind for kind in ("uniform", "log_uniform", "normal") if kind in said]
    if len(kinds) != 1:
        first = next(iter(said))
        near = did_you_mean(str(first), ["uniform", "log_uniform", "normal", "levels", "from", "to", "steps"])
        raise ConfigError(f"'{first}' says no values{near}; allowed: {', '.join(_FORMS)}")
    return _distributed(name, kinds[0], said)


def _values(said: list[Any]) -> tuple[Value, ...]:
    if not said:
        raise ConfigError("an empty list: give at least one value")
    for value in said:
        if isinstance(value, dict | list):
            raise ConfigError(f"{value!r} is not a single value")
        if isinstance(value, float) and not math.isfinite(value):
            raise ConfigError(f"{value} is not a finite number")
        if isinstance(value, str) and _looks_like_number(value):
            raise ConfigError(f"'{value}' is a text to YAML: write the number with a decimal point (1.0e-3), unquoted")
    texts = [repr(value) for value in said]
    if len(set(texts)) < len(texts):
        twice = next(text for text in texts if texts.count(text) > 1)
        raise ConfigError(f"{twice} stands there twice")
    if len({_kind(value) for value in said if value is not None}) > 1:
        raise ConfigError(f"numbers and texts in one list: {said}")
    return tuple(said)


def _kind(value: Value) -> str:
    return "truth" if isinstance(value, bool) else "text" if isinstance(value, str) else "number"


def _levels(name: str, said: dict[str, Any]) -> Levels:
    _only(said, ("levels",))
    levels = said["levels"]
    if not isinstance(levels, dict) or not levels:
        raise ConfigError("levels: a mapping NAME: {KEY: VALUE, ...} is wanted")
    for level, keys in levels.items():
        if not isinstance(level, str) or not isinstance(keys, dict | None):
            raise ConfigError(f"levels.{level}: a mapping {{KEY: VALUE, ...}} is wanted, under a name that is a text")
    if "." in name:
        raise ConfigError("a factor of levels has a name of its own, without dots, as `camera`")
    return Levels(name, None, {level: dict(keys or {}) for level, keys in levels.items()})


def _steps(name: str, said: dict[str, Any]) -> Listed:
    _only(said, ("from", "to", "steps", "scale"))
    low, high = (_number(said.get(key), key) for key in ("from", "to"))
    steps = said.get("steps")
    if not isinstance(steps, int) or isinstance(steps, bool) or not 2 <= steps <= MAX_STEPS:
        raise ConfigError(f"steps: {steps!r} is not a whole number from 2 to {MAX_STEPS}")
    scale = said.get("scale", "linear")
    if scale not in ("linear", "log"):
        raise ConfigError(f"scale: '{scale}' is not one of linear, log")
    if scale == "log" and min(low, high) <= 0.0:
        raise ConfigError(f"from {low} to {high} on a logarithmic scale: both must be above 0")
    if low == high:
        raise ConfigError(f"from {low} to {high} is one value")
    values = np.linspace(low, high, steps) if scale == "linear" else np.geomspace(low, high, steps)
    # 0.1 + 2 * 0.05 is 0.2: fifteen digits are what a person wrote.
    return Listed(name, name, tuple(float(f"{value:.15g}") for value in values))


def _distributed(name: str, kind: str, said: dict[str, Any]) -> Distributed:
    _only(said, (kind, "within") if kind == "normal" else (kind,))
    first, second = _pair(said[kind], kind)
    if kind == "normal":
        if second <= 0.0:
            raise ConfigError(f"normal: sigma is {second}, must be above 0")
        low, high = _pair(said["within"], "within") if "within" in said else (first - 4 * second, first + 4 * second)
        if not low < high:
            raise ConfigError(f"within: [{low}, {high}] is empty")
        if low > first + 8 * second or high < first - 8 * second:
            raise ConfigError(f"within: [{low}, {high}] is more than 8 sigma from the mean {first}")
        return Distributed(name, name, kind, low, high, first, second)
    if not first < second:
        raise ConfigError(f"{kind}: [{first}, {second}] is empty: the lower end comes first")
    if kind == "log_uniform" and first <= 0.0:
        raise ConfigError(f"log_uniform: {first} must be above 0")
    return Distributed(name, name, kind, first, second)


def _only(said: dict[str, Any], known: tuple[str, ...]) -> None:
    for key in said:
        if key not in known:
            raise ConfigError(f"'{key}' is not one of {', '.join(known)}{did_you_mean(str(key), known)}")


def _pair(said: Any, key: str) -> tuple[float, float]:
    if not isinstance(said, list) or len(said) != 2:
        raise ConfigError(f"{key}: {said!r} is not a list of two numbers")
    return _number(said[0], key), _number(said[1], key)


def _number(said: Any, key: str) -> float:
    if isinstance(said, bool) or not isinstance(said, int | float) or not math.isfinite(said):
        hint = " (YAML wants 1.0e-3, unquoted)" if isinstance(said, str) and _looks_like_number(said) else ""
        raise ConfigError(f"{key}: {said!r} is not a finite number{hint}")
    return float(said)


def _looks_like_number(text: Any) -> bool:
    try:
        float(text)
    except (TypeError, ValueError):
        return False
    return True
