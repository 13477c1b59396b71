"""The plane of inputs, cut into pieces on each of which u(e, ec) is one rational function. Exact, in rationals.

A rule fires at min(mu_A(e), mu_B(ec)) and a term of U is clipped at the max over its rules: a height is always one of
the degrees, and which one is decided by their order alone. On a strip of e times a strip of ec every degree is a
straight line, so the order changes across the lines mu_A(e) = mu_B(ec). They cut the rectangle into convex polygons,
the *pieces*. On a piece every height is one straight line in e or in ec, the order of the heights is fixed, and with
layers.py

    u(e, ec) = sum_k M_k(h_k) / sum_k A_k(h_k).

That formula goes on beyond the piece, over the whole rectangle, as a function f with continuous slopes. So an
enclosure of f over a box is one of u over the part of the box that lies in the piece, and the polygon's vertices need
not be kept.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product

from pilotfish import fuzzy
from pilotfish.fuzzy_proof.layers import Layers
from pilotfish.fuzzy_proof.strips import Degree, Strip, strips_of

E, EC = 0, 1  # which input a height comes from
Point = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Height:
    """Where terms of U are clipped, and what they add to the terms that are clipped higher."""

    axis: int  # E or EC
    degree: Degree
    profile: int  # of Layers
    terms: tuple[int, ...]  # of U; several if one degree clips them all


@dataclass(frozen=True)
class Piece:
    """A convex polygon of inputs: its heights, the highest first, and the sides that are not those of the rectangle."""

    vertices: tuple[Point, ...]
    heights: tuple[Height, ...]
    sides: tuple[tuple[Degree, Degree, int], ...]  # sign (mu_A(e) - mu_B(ec)) >= 0
    is_point: bool = field(default=False)  # of zero width: a vertical side


@dataclass(frozen=True)
class Surface:
    """u(e, ec) of a controller, exactly: its pieces cover every input inside both universes."""

    controller: fuzzy.Controller
    layers: Layers
    pieces: tuple[Piece, ...]


def surface_of(controller: fuzzy.Controller) -> Surface:
    """ConfigError if a set is a Gaussian."""
    layers = Layers(controller.output)
    pieces: list[Piece] = []
    rules = [[int(cell) for cell in row] for row in controller.rules.consequents]
    columns = strips_of(controller.error_change)
    for row, column in product(strips_of(controller.error), columns):
        pieces += _pieces_of(row, column, rules, layers)
    return Surface(controller, layers, tuple(pieces))


def _pieces_of(row: Strip, column: Strip, rules: list[list[int]], layers: Layers) -> list[Piece]:
    corners = [(row.begin, column.begin), (row.end, column.begin), (row.end, column.end), (row.begin, column.end)]
    polygons: list[tuple[list[Point], list[tuple[Degree, Degree, int]]]] = [(list(dict.fromkeys(corners)), [])]
    for a, b in _lines(row, column):
        cut: list[tuple[list[Point], list[tuple[Degree, Degree, int]]]] = []
        for vertices, sides in polygons:
            gaps = [a.at(x) - b.at(y) for x, y in vertices]
            if all(gap >= 0 for gap in gaps) or all(gap <= 0 for gap in gaps):
                cut.append((vertices, sides))
                continue
            for sign in (1, -1):
                cut.append((_clip(vertices, [sign * gap for gap in gaps]), [*sides, (a, b, sign)]))
        polygons = cut
    return [
        Piece(
            tuple(vertices),
            _heights(row, column, vertices, rules, layers),
            tuple(sides),
            row.is_point or column.is_point,
        )
        for vertices, sides in polygons
    ]


def _lines(row: Strip, column: Strip) -> list[tuple[Degree, Degree]]:
    """The pairs of degrees that may be equal somewhere inside the rectangle, each line once."""
    known: dict[tuple[Fraction, ...], tuple[Degree, Degree]] = {}
    spans = [
        [(degree, sorted((degree.at(strip.begin), degree.at(strip.end)))) for degree in strip.degrees]
        for strip in (row, column)
    ]
    for (a, (low_a, high_a)), (b, (low_b, high_b)) in product(*spans):
        if high_a <= low_b or high_b <= low_a:
            continue
        line = [a.slope, -b.slope, a.at(Fraction(0)) - b.at(Fraction(0))]
        lead = next((c for c in line[:2] if c), None)
        if lead is not None:
            known.setdefault(tuple(c / lead for c in line), (a, b))
    return list(known.values())


def _clip(vertices: list[Point], gaps: list[Fraction]) -> list[Point]:
    """The part of a convex polygon, or of a segment, where the gap is >= 0 (Sutherland and Hodgman)."""
    kept: list[Point] = []
    for i, (vertex, gap) in enumerate(zip(vertices, gaps, strict=True)):
        before, gap_before = vertices[i - 1], gaps[i - 1]
        if gap * gap_before < 0:
            t = gap_before / (gap_before - gap)
            kept.append((before[0] + t * (vertex[0] - before[0]), before[1] + t * (vertex[1] - before[1])))
        if gap >= 0:
            kept.append(vertex)
    return list(dict.fromkeys(kept))


def _heights(
    row: Strip, column: Strip, vertices: list[Point], rules: list[list[int]], layers: Layers
) -> tuple[Height, ...]:
    """At the mean of the vertices, which lies inside: there the degrees have the order of the whole piece."""
    x, y = (sum(v[i] for v in vertices) / len(vertices) for i in (0, 1))
    rows = [(degree.at(x), E, degree) for degree in row.degrees]
    columns = [(degree.at(y), EC, degree) for degree in column.degrees]
    best: dict[int, tuple[Fraction, int, Degree]] = {}
    for a, b in product(rows, columns):
        strength = a if a[0] <= b[0] else b
        term = rules[a[2].term][b[2].term]
        if strength[0] > 0 and (term not in best or strength[0] > best[term][0]):
            best[term] = strength
    alike: dict[tuple[int, Fraction, Fraction], list[int]] = {}
    for term, (_, axis, degree) in sorted(best.items(), key=lambda item: item[1][0], reverse=True):
        alike.setdefault((axis, degree.slope, degree.at(Fraction(0))), []).append(term)
    # Terms that one degree clips are one summand, so that what cancels between them cancels exactly.
    heights: list[Height] = []
    higher: list[int] = []
    for (axis, _, _), terms in alike.items():
        profiles = []
        for term in terms:
            profiles.append(layers.profile(term, frozenset(higher)))
            higher.append(term)
        heights.append(Height(axis, best[terms[0]][2], layers.together(profiles), tuple(terms)))
    return tuple(heights)
