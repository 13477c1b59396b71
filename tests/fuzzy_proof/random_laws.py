"""Random fuzzy controllers for hypothesis: triangles and trapezoids, vertical sides and open shoulders among them."""

import math

from hypothesis import assume
from hypothesis import strategies as st

from pilotfish import fuzzy

ROWS, COLUMNS = 8, 7
OUTPUTS = 5
TENTHS = st.integers(-12, 12).map(lambda n: n / 10)  # shared corners and vertical sides must be frequent


@st.composite
def covering_variables(draw, name, count):
    """An input: knots over [-1, 1]; term k rises to 1 at knot k. Neighbours share corners, or reach farther."""
    inner = draw(st.lists(st.integers(-9, 9), min_size=count - 2, max_size=count - 2, unique=True))
    knots = [-1.0, *(k / 10 for k in sorted(inner)), 1.0]
    wide = draw(st.sampled_from([0.0, 0.0, 0.0, 0.05]))
    terms = []
    for k in range(count):
        left = -math.inf if k == 0 else knots[k - 1] - wide
        right = math.inf if k == count - 1 else knots[k + 1] + wide
        kind = draw(st.sampled_from(["tent", "tent", "tent", "box"]))
        inner = (left, left) if k == 0 else (left, left if kind == "box" else knots[k])
        outer = (right, right) if k == count - 1 else (knots[k], right)
        terms.append(fuzzy.Term(f"T{k}", fuzzy.Trapezoid(inner[0], inner[1], outer[0], outer[1])))
    return fuzzy.LinguisticVariable(name, terms)


@st.composite
def output_variables(draw):
    """In any order on the axis, over a universe of any width, partly beyond it."""
    terms = []
    for k in range(OUTPUTS):
        a, b, c, d = sorted(draw(st.lists(TENTHS, min_size=4, max_size=4)))
        assume(d - a > 0.15 and d > -0.9 and a < 0.9)
        terms.append(
            fuzzy.Term(f"U{k}", fuzzy.Triangle(a, b, d) if draw(st.booleans()) else fuzzy.Trapezoid(a, b, c, d))
        )
    return fuzzy.LinguisticVariable("U", terms, min=-1.0, max=draw(st.sampled_from([1.0, 1.3])))


@st.composite
def controllers(draw):
    """Valid ones only."""
    cells = draw(st.lists(st.integers(0, OUTPUTS - 1), min_size=ROWS * COLUMNS, max_size=ROWS * COLUMNS))
    rules = [cells[i * COLUMNS : (i + 1) * COLUMNS] for i in range(ROWS)]
    try:
        return fuzzy.Controller(
            error=draw(covering_variables("E", ROWS)),
            error_change=draw(covering_variables("EC", COLUMNS)),
            output=draw(output_variables()),
            rules=fuzzy.RuleBase(rules),
            name="random",
        )
    except ValueError:
        assume(False)
