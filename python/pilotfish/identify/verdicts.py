"""Which keys of the configuration to set, from a fit: value, standard deviation, what the run had, a verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import yaml

from pilotfish.identify.fit import DriveFit, Estimate
from pilotfish.logs.notes import Settings
from pilotfish.logs.settings_keys import keys_of

_STEADY_MPS, _STEADY_RADPS = 0.01, 0.02
_CHANCE = 3.0  # standard deviations; z-scores of simulated runs have tails a little wider than a Gaussian's
_HOW = "drive stop-and-go for 20 s"


@dataclass(frozen=True)
class KeyVerdict:
    """``key``: dotted, of the file ``file`` ("coordinator" or "base"). ``value`` is None where the run does not say.
    ``had``: what the run's own configuration said, or the default with ``had_default``; None: not known."""

    file: str
    key: str
    value: float | None
    sigma: float | None
    had: float | None
    had_default: bool
    verdict: str
    recommended: bool  # differs from what the run had by more than chance, and can be set


def verdicts_of(
    fit: DriveFit,
    settings: Settings | None = None,
    *,
    wheel_radius_m: float | None = None,
    track_width_m: float | None = None,
) -> list[KeyVerdict]:
    """``settings``: of a black box. The wheels' dimensions are those that the run was driven with, of the configuration
    of pilotfish-base; without them their keys are given as factors."""
    said = settings_numbers(settings)
    rows = [
        _delay(fit, "control.drive.latency_s", fit.latency_s, (0.0, 0.25), said, 1.0 / 30.0, settings),
        _delay(fit, "control.drive.actuator_lag_s", fit.lag_s, (0.0, 1.0), said, 0.1, settings),
        _dimension(fit, "wheels.wheel_radius_m", fit.linear_gain, wheel_radius_m, 0.0),
    ]
    ratio = _ratio(fit.linear_gain, fit.angular_gain)
    rows.append(_dimension(fit, "wheels.track_width_m", ratio, track_width_m, 0.0))
    return rows


def settings_numbers(settings: Settings | None) -> dict[str, float]:
    """Numbers of the coordinator's own file and, before it, of its tuning file."""
    if settings is None:
        return {}
    numbers: dict[str, float] = {}
    keys = keys_of(settings)
    for role in ("tuning: ", "config: "):
        for key, text in keys.items():
            if key.startswith(role):
                try:
                    numbers[key.removeprefix(role)] = float(text)
                except ValueError:
                    continue
    return numbers


def as_yaml(verdicts: list[KeyVerdict], source: str) -> str:
    """A fragment for the coordinator's file: the delays that the run determines. Keys of pilotfish-base are comments,
    because they stand in another file."""
    tree: dict[str, Any] = {}
    lines = [f"# Identified by `pilotfish identify` from {' '.join(source.split())}; +- one standard deviation."]
    for row in verdicts:
        sigma = "" if row.sigma is None else f" +- {row.sigma:.4f}"
        if row.value is None or not row.recommended:
            lines.append(f"# {row.key}: not changed; {row.verdict}")
            continue
        if row.file == "coordinator":
            lines.append(f"# {row.key}: {row.value:.4f}{sigma}")
            *path, last = row.key.split(".")
            place = tree
            for name in path:
                place = place.setdefault(name, {})
            place[last] = round(row.value, 4)
        else:
            lines.append(f"# in the file of pilotfish-base: {row.key}: {row.value:.5g}{sigma}")
    body = yaml.safe_dump(tree, sort_keys=False) if tree else "{}\n"
    return "\n".join(lines) + "\n" + body


def _unobservable(fit: DriveFit, turning: bool) -> str:
    steady = fit.turn_change_radps < _STEADY_RADPS if turning else fit.speed_change_mps < _STEADY_MPS
    if steady:
        what = "turn rate" if turning else "speed"
        how = "let the leader weave for 20 s" if turning else _HOW
        return f"not observable in this run: the robot never changed its {what}; {how}"
    return f"not observable in this run: the changes were too few or too slow; {_HOW}, turning now and then"


def _delay(
    fit: DriveFit,
    key: str,
    found: Estimate,
    allowed: tuple[float, float],
    said: Mapping[str, float],
    default: float,
    settings: Settings | None,
) -> KeyVerdict:
    had_default = settings is not None and key not in said
    had = said.get(key, default if settings is not None else None)
    if not found.observable:
        return KeyVerdict("coordinator", key, None, found.sigma, had, had_default, _unobservable(fit, False), False)
    value = found.value
    if not allowed[0] <= value <= allowed[1]:
        verdict = f"outside of what can be configured ({allowed[0]:g} to {allowed[1]:g} s): make the drive faster"
        return KeyVerdict("coordinator", key, value, found.sigma, had, had_default, verdict, False)
    verdict, differs = _compared(value, found.sigma, had, least=0.002)
    return KeyVerdict("coordinator", key, value, found.sigma, had, had_default, verdict, differs)


def _dimension(fit: DriveFit, key: str, factor: Estimate, had: float | None, least: float) -> KeyVerdict:
    """v = radius x mean wheel speed, so the radius that was assumed times the speed gain is true; w = difference of the
    wheels' ground speeds / track, so the track that was assumed times (speed gain / turn gain) is true."""
    turning = key.endswith("track_width_m")
    if not factor.observable:
        return KeyVerdict("base", key, None, factor.sigma, had, False, _unobservable(fit, turning), False)
    if turning and abs(factor.value - 1.0) >= _CHANCE * factor.sigma:  # rendered pictures: 1.06 where 1 is true
        verdict = (
            f"a hint, not to be set: factor {factor.value:.4f} +- {factor.sigma:.4f}, and pictures err by more than "
            "that; let it turn ten times on the spot and measure"
        )
        return KeyVerdict("base", key, None, factor.sigma, had, False, verdict, False)
    if had is None:
        off = abs(factor.value - 1.0)
        verdict = f"multiply what the base has by {factor.value:.4f} +- {factor.sigma:.4f}"
        if off < _CHANCE * factor.sigma:
            verdict = f"agrees with what the base has (factor {factor.value:.4f} +- {factor.sigma:.4f})"
        return KeyVerdict("base", key, None, factor.sigma, None, False, verdict, False)
    value, sigma = had * factor.value, had * factor.sigma
    verdict, differs = _compared(value, sigma, had, least)
    return KeyVerdict("base", key, value, sigma, had, False, verdict, differs)


def _ratio(a: Estimate, b: Estimate) -> Estimate:
    value = a.value / b.value
    sigma = value * ((a.sigma / a.value) ** 2 + (b.sigma / b.value) ** 2) ** 0.5
    return Estimate(value, sigma, a.observable and b.observable)


def _compared(value: float, sigma: float, had: float | None, least: float) -> tuple[str, bool]:
    if had is None:
        return "set it; what the run had is not recorded", True
    off = value - had
    if abs(off) < max(_CHANCE * sigma, least):
        return "what the run had is right", False
    return f"set it: what the run had is {abs(off) / sigma:.0f} standard deviations off", True
