"""What the tracker is to reach, as rows: the goal, the baseline's figure, ours, their ratio, and whether it is met."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from bench.vision.accuracy import Cells
from bench.vision.chains import Results
from bench.vision.conditions import ROLLING_SHUTTER
from bench.vision.summary import Figures, ratio
from bench.vision.trackers import ACQUIRED, TRACKED, VISP_1, VISP_2, WHEEL
from bench.vision.units import mm, ms, percent
from bench.vision.without_leader import Verdict

NEAR_M = (0.65, 1.1, 2.44)
SIZE = "640x480"
FLAT = 1.2  # a tracked frame may cost so much more in the largest image than in the smallest


@dataclass(frozen=True)
class Goal:
    """One row. `ratio` is ours over the baseline's, NaN if there is nothing to divide by."""

    name: str
    bound: str
    baseline: str
    ours: str
    ratio: float
    met: bool


def at_most(
    name: str, bound: float, text: str, baseline: str, theirs: float, ours: float, unit: Callable[[float], str]
) -> Goal:
    """ours / theirs <= bound. A figure that is missing meets nothing."""
    quotient = ratio(ours, theirs)
    return Goal(name, text, f"{baseline}: {unit(theirs)}", unit(ours), quotient, quotient <= bound)


def below(name: str, baseline: str, theirs: float, ours: float) -> Goal:
    """ours < theirs: as good is not better."""
    quotient = ratio(ours, theirs)
    return Goal(name, "below the better", f"{baseline}: {mm(theirs)}", mm(ours), quotient, quotient < 1.0)


def accuracy_goals(cells: Cells) -> Iterator[Goal]:
    """Time and accuracy in the 640x480 cells."""
    vga = cells[SIZE]
    for d in NEAR_M:
        trackers = vga[d]
        ours = trackers[TRACKED].median_ms
        for bound, text, baseline in ((1 / 200, "≤ 1/200", VISP_1), (1 / 50, "≤ 1/50", VISP_2)):
            yield at_most(
                f"time per tracked frame, {d} m", bound, text, baseline, trackers[baseline].median_ms, ours, ms
            )
    for d, trackers in vga.items():
        theirs, ours = trackers[VISP_2], trackers[ACQUIRED]
        row = at_most(f"time per acquired frame, {d} m", 0.7, "≤ 0.7", VISP_2, theirs.median_ms, ours.median_ms, ms)
        as_often = ours.seen >= theirs.seen
        seen = (f"{row.baseline}, seen {percent(theirs.seen)}", f"{row.ours}, seen {percent(ours.seen)}")
        yield Goal(row.name, f"{row.bound}, seen as often", *seen, row.ratio, row.met and as_often)
    for d, trackers in vga.items():
        best = min((VISP_1, WHEEL), key=lambda name: _known(trackers[name].median_mm))
        yield below(f"median distance error, {d} m", best, trackers[best].median_mm, trackers[TRACKED].median_mm)
    for name, figure in (("median distance error", "median_mm"), ("95th percentile", "p95_mm")):
        for d in NEAR_M:
            theirs, ours = (getattr(vga[d][tracker], figure) for tracker in (VISP_1, TRACKED))
            yield at_most(f"{name}, {d} m", 0.5, "≤ 1/2 of ViSP", VISP_1, theirs, ours, mm)


def heading_goals(far: dict[str, Figures], head_on: dict[str, Figures]) -> Iterator[Goal]:
    """The filtered heading of a single tag on a sequence."""
    for name, trackers in (("heading > 10° wrong, 5 m", far), ("heading > 10° wrong, head-on 2 to 4 m", head_on)):
        baseline = min((VISP_1, WHEEL), key=lambda tracker: _known(trackers[tracker].headings_wrong))
        theirs, ours = trackers[baseline].headings_wrong, trackers[TRACKED].headings_wrong
        yield Goal(name, "≤ 1 %", f"{baseline}: {percent(theirs)}", percent(ours), ratio(ours, theirs), ours <= 0.01)


def drive_goals(trackers: dict[str, Figures]) -> Iterator[Goal]:
    """Frames of the drive in which the leader is seen."""
    for baseline in (VISP_1, VISP_2):
        theirs, ours = trackers[baseline].seen, trackers[TRACKED].seen
        quotient = ratio(ours, theirs)
        name = f"frames of the drive with the leader seen, of {trackers[baseline].frames}"
        yield Goal(name, "≥ 1.0", f"{baseline}: {percent(theirs)}", percent(ours), quotient, quotient >= 1.0)


def chain_goals(results: Results) -> Iterator[Goal]:
    """Seen as often as the better baseline, and a covariance that says how far off that is."""
    for condition, by_distance in results.items():
        for d, trackers in by_distance.items():
            ours = trackers[TRACKED]
            best = max((VISP_1, WHEEL), key=lambda name, of=trackers: of[name].seen)
            theirs = trackers[best].seen
            name = f"{condition}, {d} m: seen"
            yield Goal(
                name,
                "≥ 1.0",
                f"{best}: {percent(theirs)}",
                percent(ours.seen),
                ratio(ours.seen, theirs),
                ours.seen >= theirs,
            )
            said = f"{ours.chi2:.2f}, {ours.sure_and_wrong} of {ours.frames} beyond 5 sigma"
            if condition == ROLLING_SHUTTER:
                other = min((VISP_1, WHEEL), key=lambda name, of=trackers: of[name].p95_deg)
                least = trackers[other].p95_deg
                yield Goal(
                    f"{condition}, {d} m: heading p95",
                    "≤ 0.5",
                    f"{other}: {least:.2f} deg",
                    f"{ours.p95_deg:.2f} deg",
                    ratio(ours.p95_deg, least),
                    ours.p95_deg <= 0.5 * least,
                )
            yield Goal(f"{condition}, {d} m: chi2/dof", "≤ 2", "-", said, math.nan, not ours.chi2 > 2.0)


def wrong_leader_goals(verdict: Verdict) -> Iterator[Goal]:
    """Nothing else may be taken for the leader; a tracker that never saw it would prove nothing."""
    ours = f"{verdict.wrong} (leader seen in {verdict.seen} of {verdict.shown} frames between)"
    met = verdict.wrong == 0 and verdict.seen > verdict.shown / 2
    yield Goal(f"wrong leaders in {verdict.frames} frames without one", "0", "-", ours, math.nan, met)


def resolution_goals(by_size: dict[str, dict[str, Figures]]) -> Iterator[Goal]:
    """Largest frame over smallest, for the same tag in pixels."""

    def pixels(size: str) -> int:
        return math.prod(int(side) for side in size.split("x"))

    small, large = min(by_size, key=pixels), max(by_size, key=pixels)
    growth = {
        tracker: ratio(by_size[large][tracker].median_ms, by_size[small][tracker].median_ms)
        for tracker in (VISP_1, TRACKED)
    }
    theirs, ours = (f"{growth[tracker]:.2f}x" for tracker in (VISP_1, TRACKED))
    quotient = ratio(growth[TRACKED], growth[VISP_1])
    name = f"time at {large} over {small}, tracked"
    yield Goal(name, f"flat: ≤ {FLAT}x", f"{VISP_1}: {theirs}", ours, quotient, growth[TRACKED] <= FLAT)


def visp_goals(medians: dict[str, dict[str, float]]) -> Iterator[Goal]:
    """On ViSP's own pictures no baseline shall be better."""
    for size, by_tracker in medians.items():
        best = min((VISP_1, WHEEL), key=lambda tracker: _known(by_tracker[tracker]))
        name = f"median distance error, ViSP's picture {size}"
        yield below(name, best, by_tracker[best], by_tracker[TRACKED])


def _known(value: float) -> float:
    """A figure to minimise: what is missing is worst."""
    return math.inf if math.isnan(value) else value
