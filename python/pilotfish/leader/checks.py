"""What is wrong, or worth knowing, about a leader's tags; in words."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

import numpy as np

from pilotfish.core import LeaderBody
from pilotfish.leader.reach import Viewer, reach_of_body, tag_reach
from pilotfish.leader.sheets import Sheet, overlap, sheet_of, to_fold_m
from pilotfish.leader.visibility import Visibility, number_of_planes
from pilotfish.printing.quantities import millimetres

_TOUCH_M = 0.001  # sheets that are folded or butted touch; leader files are rounded
_MEET, _APART = 0.06, 0.3  # of half a sheet, from its edge to the fold: more than folds of some millimetres, less than
# what is meant as a gap
_INWARD = -0.3  # cosine between where a tag looks and where it sits
_UPWARD = math.cos(math.radians(75.0))
_BEHIND_DEG = 180.0


class Level(str, Enum):
    """How bad a finding is."""

    error = "error"
    warning = "warning"
    note = "note"


@dataclass(frozen=True)
class Finding:
    """One thing found, and what to do about it."""

    level: Level
    text: str


def check_leader(body: LeaderBody, visibility: Visibility, viewer: Viewer | None = None) -> list[Finding]:
    """All findings, errors first. visibility: as look_all_round makes it; viewer: None if no camera is known."""
    found = [
        *_overlaps(body),
        *_folds(body),
        *_places(body),
        *_hidden(body, visibility),
        *_heading(body),
        *_directions(visibility),
    ]
    if viewer is not None:
        found += _distances(body, viewer)
    order = list(Level)
    return sorted(found, key=lambda finding: order.index(finding.level))


def _overlaps(body: LeaderBody) -> Iterator[Finding]:
    black = [sheet_of(tag, body.family, with_border=False) for tag in body.tags]
    paper = [sheet_of(tag, body.family) for tag in body.tags]
    for b in range(len(black)):
        for a in range(b):
            which = f"tags {body.tags[a].id} and {body.tags[b].id}"
            if overlap(black[a].shrunk(_TOUCH_M), black[b].shrunk(_TOUCH_M)):
                yield Finding(Level.error, f"{which} overlap: their black squares are in the same place; move one")
            elif overlap(paper[a].shrunk(_TOUCH_M), black[b].shrunk(_TOUCH_M)) or overlap(
                paper[b].shrunk(_TOUCH_M), black[a].shrunk(_TOUCH_M)
            ):
                yield Finding(Level.warning, f"{which}: one lies in the white border (one cell) that the other needs")
            elif overlap(paper[a].shrunk(_TOUCH_M), paper[b].shrunk(_TOUCH_M)):
                sizes = _sizes_that_fit(body, paper, a, b)
                yield Finding(
                    Level.warning,
                    f"{which}: their white borders (one cell each) overlap; "
                    + (f"size_m and position_m contradict each other: {sizes}" if sizes else "move them apart"),
                )


def _folds(body: LeaderBody) -> Iterator[Finding]:
    """Faces that nearly meet: were they cut from one sheet, their sizes are smaller than their places say."""
    paper = [sheet_of(tag, body.family) for tag in body.tags]
    for b in range(len(paper)):
        for a in range(b):
            apart_m = to_fold_m(paper[a], paper[b])
            if apart_m is None:
                continue
            if all(_MEET < apart / paper[k].half_m - 1.0 < _APART for k, apart in zip((a, b), apart_m, strict=True)):
                gap_m = sum(apart_m) - paper[a].half_m - paper[b].half_m
                yield Finding(
                    Level.note,
                    f"tags {body.tags[a].id} and {body.tags[b].id}: {1000 * gap_m:.0f} mm between the sheets of two "
                    f"faces that fold; if they are one folded sheet, size_m and position_m contradict each other: "
                    f"{_sizes_that_fit(body, paper, a, b)}",
                )


def _sizes_that_fit(body: LeaderBody, paper: list[Sheet], a: int, b: int) -> str:
    """Sizes with which two faces would meet at their fold, and what to measure; empty for faces that do not fold."""
    apart_m = to_fold_m(paper[a], paper[b])
    if apart_m is None:
        return ""
    share = sum(apart_m) / (paper[a].half_m + paper[b].half_m)
    sizes_m = sorted({tag.size_m for tag in (body.tags[a], body.tags[b])})
    fit = " and ".join(f"{share * size_m:.3f} m instead of {size_m:g} m" for size_m in sizes_m)
    return (
        f"they would meet with black squares of {fit}, or a little less; measure the black square with a ruler: one "
        "that is said to be 10 % too large makes every distance 10 % too far"
    )


def _places(body: LeaderBody) -> Iterator[Finding]:
    for tag in body.tags:
        sheet = sheet_of(tag, body.family, with_border=False)
        flat, place = sheet.looks[:2], sheet.centre_m[:2]
        length, away = float(np.linalg.norm(flat)), float(np.linalg.norm(place))
        if length < _UPWARD:
            where = "up" if sheet.looks[2] > 0 else "down"
            yield Finding(Level.warning, f"tag {tag.id} looks {where}: no robot on the ground sees it squarely")
        elif away > 0.02 and flat @ place / (length * away) < _INWARD:
            outward = math.degrees(math.atan2(place[1], place[0]))
            yield Finding(
                Level.warning,
                f"tag {tag.id} faces into the body: it sits at {_signed(place)} from the turning centre and looks back"
                f" across it; outward would be facing_deg {outward:.0f}, not {math.degrees(tag.facing_rad):.0f}",
            )
        lowest = float(sheet.corners_m()[:, 2].min())
        if lowest < -_TOUCH_M:
            yield Finding(
                Level.warning,
                f"tag {tag.id} reaches {millimetres(-lowest)} below the ground: position_m is its centre, counted from"
                f" the ground; heights that are all wrong by the same do not harm distance and bearing",
            )


def _signed(place: np.ndarray) -> str:
    return f"({place[0]:.2f}, {place[1]:.2f}) m"


def _hidden(body: LeaderBody, visibility: Visibility) -> Iterator[Finding]:
    for k, tag in enumerate(body.tags):
        if not visibility.seen[:, k].any() and np.linalg.norm(tag.oMt[:2, 2]) >= _UPWARD:
            yield Finding(
                Level.error,
                f"tag {tag.id} is seen from no direction at {visibility.distance_m:g} m: other tags hide it, or it"
                f" looks away",
            )


def _heading(body: LeaderBody) -> Iterator[Finding]:
    if number_of_planes(body) > 1:
        return
    count = "one flat tag" if len(body.tags) == 1 else f"all {len(body.tags)} tags are in one plane"
    yield Finding(
        Level.note,
        f"{count}: from a distance the heading is ambiguous in one picture and is decided over several; distance and"
        f" bearing are not affected. Tags in two planes, folded by 30 degrees or more, leave no doubt",
    )


def _directions(visibility: Visibility) -> Iterator[Finding]:
    if not visibility.at(_BEHIND_DEG).any():
        yield Finding(
            Level.warning,
            f"from straight behind (180°) no tag is seen at {visibility.distance_m:g} m: a follower drives there",
        )
    blind = visibility.blind()
    if blind:
        which = ", ".join(str(sector) for sector in blind)
        total = 100.0 * float(np.mean(~visibility.seen.any(axis=1)))
        yield Finding(
            Level.note,
            f"no tag is seen from {which}: {total:.0f} % of all round (0° is its front, 90° its left, 180° behind)",
        )


def _distances(body: LeaderBody, viewer: Viewer) -> Iterator[Finding]:
    nearest, found_to, followed_to = reach_of_body(tag_reach(body, viewer))
    if math.isinf(nearest):
        yield Finding(Level.error, "no tag fits into the picture within 5 m: where does the camera look?")
        return
    yield Finding(
        Level.note,
        f"with this camera it can be followed from {nearest:.2f} m to {followed_to:.1f} m and is found up to"
        f" {found_to:.1f} m (between the turning centres, tags seen squarely and sharply)",
    )
    if nearest >= followed_to:
        yield Finding(Level.error, "it is too near or too far everywhere: larger tags, or another lens")
