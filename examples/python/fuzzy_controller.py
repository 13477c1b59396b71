"""A Mamdani controller of one's own, after the paper's pattern (8 x 7 rules), that keeps a cart 1 m behind a leader."""

import math
import signal

from pilotfish import fuzzy

for number in (signal.SIGINT, signal.SIGPIPE):
    signal.signal(number, signal.SIG_DFL)  # Ctrl-C and `| head` end it, as any program
SEVEN = ["NB", "NM", "NS", "ZE", "PS", "PM", "PB"]
PEAKS = [-0.9, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9]


def variable(name: str, labels: list[str], peaks: list[float], *, shoulders: bool) -> fuzzy.LinguisticVariable:
    """Triangles whose feet stand under the neighbours' peaks, and open shoulders at both ends."""
    feet = [peaks[0] - 0.3, *peaks, peaks[-1] + 0.3]
    terms = [fuzzy.Term(label, fuzzy.Triangle(*feet[i : i + 3])) for i, label in enumerate(labels)]
    if shoulders:
        terms[0] = fuzzy.Term(labels[0], fuzzy.Trapezoid(-math.inf, -math.inf, feet[1], feet[2]))
        terms[-1] = fuzzy.Term(labels[-1], fuzzy.Trapezoid(feet[-3], feet[-2], math.inf, math.inf))
    return fuzzy.LinguisticVariable(name, terms)


def consequent(row: int, column: int) -> int:
    """Too far (E negative) or getting farther (EC negative): faster. One step of U for one step of either."""
    step = (3 - row if row < 4 else 4 - row) + (3 - column)
    return 3 + max(-3, min(3, step))


controller = fuzzy.Controller(
    name="cart",
    error=variable(
        "E",
        ["NB", "NM", "NS", "NZ", "PZ", "PS", "PM", "PB"],
        [-0.9, -0.6, -0.3, -0.02, 0.02, 0.3, 0.6, 0.9],
        shoulders=True,
    ),
    error_change=variable("EC", SEVEN, PEAKS, shoulders=True),
    output=variable("U", SEVEN, PEAKS, shoulders=False),
    rules=fuzzy.RuleBase([[consequent(row, column) for column in range(7)] for row in range(8)]),
)

gap_m, last_error_m = 1.8, -0.8
for step in range(61):
    error_m = 1.0 - gap_m
    speed = fuzzy.infer(controller, error_m, error_m - last_error_m).output
    if step % 10 == 0:
        print(f"{step * 0.1:4.1f} s: {gap_m:.3f} m behind, {speed:+.2f} m/s relative")
    gap_m -= 0.1 * speed
    last_error_m = error_m
