"""What a soak must show, and what it did."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from census import Census
from run import Soak

GROWTH_MB, RECOVERY_S = 1.0, 1.0
_ROUNDING_S = 1e-6  # robot time is a sum of periods


@dataclass(frozen=True)
class Goal:
    words: str
    goal: str
    found: str
    met: bool | None  # None: no goal, or it was too short to tell


def goals(soak: Soak) -> list[Goal]:
    return [*_of_driving(soak), *(goal for name, census in soak.census.items() for goal in _of_process(name, census))]


def recoveries(soak: Soak) -> dict[str, list[float]]:
    """By fault, in robot time [s]; without those during which the measuring script stood still."""
    found: dict[str, list[float]] = {}
    for played in soak.played:
        if not played.disturbed:
            found.setdefault(played.kind, []).append(played.recovery_s)
    return found


def _of_driving(soak: Soak) -> list[Goal]:
    recovered = [played for played in soak.played if not played.disturbed]
    slow = [played for played in recovered if played.recovery_s > RECOVERY_S + _ROUNDING_S]
    longest = max((played.recovery_s for played in recovered), default=0.0)
    words = f"{longest:.3f} s; {len(slow)} of {len(recovered)} are longer"
    violations = len(soak.violations)
    codes = ", ".join(f"{name} {code}" for name, code in soak.ended.items())
    return [
        Goal("longest recovery, robot time", f"<= {RECOVERY_S:g} s", words, not slow),
        Goal("commands that break the 100 ms rule", "0", f"{violations} of {soak.commands}", violations == 0),
        Goal("exit codes after SIGTERM", "0", codes, all(code == 0 for code in soak.ended.values())),
    ]


def _of_process(name: str, census: Census) -> Iterable[Goal]:
    growth = census.growth()
    memory = f"< {GROWTH_MB:g} MB"
    if growth is None:
        yield Goal(f"{name}: memory after 10 min", memory, "too short to tell", None)
    else:
        for words, grown_mb in (
            ("fitted line since 10 min", growth.fitted_mb),
            ("last hour's lowest above the first's", growth.lowest_mb),
            ("last hour's median above the first's", growth.median_mb),
            ("last hour's p95 above the first's", growth.high_mb),
        ):
            yield Goal(f"{name}: memory, {words}", memory, f"{grown_mb:+.2f} MB", grown_mb < GROWTH_MB)
        yield Goal(f"{name}: memory, last hour's maximum above 10 min", "-", f"{growth.highest_mb:+.2f} MB", None)
    for what, values in (("descriptors", census.descriptors), ("threads", census.threads)):
        few, many = min(values), max(values)
        yield Goal(f"{name}: {what}", "constant", str(few) if few == many else f"{few} to {many}", few == many)
