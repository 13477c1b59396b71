"""How ``pilotfish doctor --following`` shows a diagnosis on a terminal."""

from __future__ import annotations

import math

from rich.console import Console
from rich.markup import escape

from pilotfish.cli.advice import print_finding
from pilotfish.doctor.following import Diagnosis, Evidence
from pilotfish.doctor.following.evidence import Numbers
from pilotfish.reason_words import reason_text

_MOST_COUNTERS = 8
_SPREAD_M = 0.02


def print_diagnosis(diagnosis: Diagnosis, console: Console) -> None:
    """The verdict, the causes with what to do, and the figures they come from."""
    verdict = "[bold green]follows[/]" if diagnosis.follows else "[bold red]does not follow[/]"
    head = f"[bold]{escape(diagnosis.robot)}[/] {verdict} (watched for {diagnosis.seconds:g} s)"
    console.print(head, soft_wrap=True)
    for number, cause in enumerate(diagnosis.causes, start=1):
        print_finding(console, [(f"{number}.", 2, "bold red")], cause.what, cause.do)
    for note in diagnosis.notes:
        print_finding(console, [("-", 2, "yellow")], note.what, note.do)
    if diagnosis.evidence:
        driver = diagnosis.base_here.driver if diagnosis.base_here else ""
        console.print()
        for name, text in [*figures(diagnosis.evidence, driver), *_computer(diagnosis)]:
            print_finding(console, [(name, 16, "dim")], text)


def figures(seen: Evidence, driver: str = "") -> list[tuple[str, str]]:
    """Pure: what was measured, a line each. ``driver``: of the wheels' process, if it is known."""
    looked = seen.frame_rate_hz > 0.0  # else there was nothing to measure
    rows = [
        ("status", _shares(seen.status_shares)),
        (
            "reasons",
            _shares({reason_text(name): share for name, share in seen.reason_shares.items() if name != "none"}),
        ),
        ("rates", _rates(seen)),
        ("latency", looked * (_milliseconds(seen.latency_s, 1000.0) + _counted_from(seen))),
        ("vision", looked * _milliseconds(seen.processing_ms, 1.0)),
        ("distance error", _error(seen)),
        ("bearing", _bearing(seen)),
        ("commanded", _commanded(seen)),
        ("wheels", _wheels(seen, driver)),
        ("counters rose", _counters(seen.counters_risen)),
        ("of the wheels", _counters(seen.base_counters_risen)),
    ]
    if seen.missed_deadlines:
        rows.append(("missed deadlines", str(seen.missed_deadlines)))
    return [(name, text) for name, text in rows if text]


def _computer(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """Its load; nothing of a coordinator on another computer."""
    return [("its computer", str(diagnosis.machine))] if diagnosis.machine else []


def _shares(shares: dict[str, float]) -> str:
    return ", ".join(f"{name} {100 * share:.0f} %" for name, share in shares.items())


def _rates(seen: Evidence) -> str:
    parts = [f"commands {seen.command_rate_hz:.1f} Hz", f"status {seen.status_rate_hz:.1f} Hz"]
    if math.isfinite(seen.frame_rate_hz):
        parts.append(f"frames {seen.frame_rate_hz:.1f} Hz")
    for channel, rate_hz in seen.image_rate_hz.items():
        sizes = ", ".join(f"{width}x{height}" for width, height in seen.image_sizes.get(channel, {}))
        parts.append(f"{channel} {rate_hz:.1f} Hz ({sizes})")
    if seen.base_rate_hz:
        parts.append(f"wheels {seen.base_rate_hz:.1f} Hz")
    return ", ".join(parts)


def _milliseconds(numbers: Numbers, factor: float) -> str:
    if not numbers.count:
        return ""
    return f"median {factor * numbers.median:.1f} ms, at most {factor * numbers.maximum:.1f} ms"


def _counted_from(seen: Evidence) -> str:
    if not seen.latency_s.count:
        return ""
    return ", from the exposure" if seen.latency_from_exposure else ", from the arrival"


def _error(seen: Evidence) -> str:
    if not math.isfinite(seen.error_last_m):
        return ""
    wanted = f" (wanted {seen.setpoint_distance_m:.2f} m)"
    low, high = seen.swing.lowest_m, seen.swing.highest_m
    between = f", between {_signed(low)} and {_signed(high)}" if high - low >= _SPREAD_M else ""
    return f"{_signed(seen.error_first_m)} at first, {_signed(seen.error_last_m)} at last{between}{wanted}"


def _signed(error_m: float) -> str:
    """e = wanted - measured, positive: too close."""
    if abs(error_m) < 0.0005:
        return "0 mm"
    return f"{1000 * abs(error_m):.0f} mm too {'far' if error_m < 0 else 'close'}"


def _bearing(seen: Evidence) -> str:
    """theta, positive: to the left."""
    first, last, wanted = seen.sight.bearing_first_rad, seen.sight.bearing_last_rad, seen.setpoint_bearing_rad
    if not all(map(math.isfinite, (first, last, wanted))):
        return ""
    first_deg, last_deg, wanted_deg = map(math.degrees, (first, last, wanted))
    return f"{first_deg:.1f} deg at first, {last_deg:.1f} deg at last (wanted {wanted_deg:.1f} deg)"


def _commanded(seen: Evidence) -> str:
    speed, turn, (least, most) = seen.commanded_mps, seen.commanded_radps, seen.commanded_range_mps
    if not speed.count:
        return ""
    turning = f"; turns median {turn.median:.2f} rad/s, at most {turn.maximum:.2f} rad/s" if turn.count else ""
    return f"median {speed.median:.2f} m/s, from {least:.2f} to {most:.2f} m/s{turning}"


def _wheels(seen: Evidence, driver: str) -> str:
    if not seen.base_state:
        others = ", ".join(sorted(seen.other_bases))
        return "no pilotfish-base of it on the bus" + (f", but of {others}" if others else "")
    said = seen.base_text if seen.base_text.startswith(seen.base_state) else f"{seen.base_state} {seen.base_text}"
    dry = "dry_run: no wheels turn" if driver == "dry_run" else driver
    return f"{said} (driver {dry})" if driver else said


def _counters(risen: dict[str, int]) -> str:
    shown = [f"{name} +{count}" for name, count in list(risen.items())[:_MOST_COUNTERS]]
    more = len(risen) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more > 0 else "")
