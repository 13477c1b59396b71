"""Why the law says what it says: the rules in words, and the set whose centroid is the output."""

import math

import numpy as np
import pytest
from fuzzy_builders import make_controller

from pilotfish import fuzzy


def test_the_rules_that_fire_come_in_words_strongest_first(controller):
    # NS(-0.2) = 0.2/0.3 = 0.67 and NZ(-0.2) = 0.1/0.28 = 0.36; ZE(0.1) = 0.2/0.3 and PS(0.1) = 1/3.
    explanation = fuzzy.explain(controller, -0.2, 0.1)
    assert [firing.text for firing in explanation.firing] == [
        "IF E is NS AND EC is ZE THEN U is PM, 0.67",
        "IF E is NZ AND EC is ZE THEN U is ZE, 0.36",
        "IF E is NS AND EC is PS THEN U is PM, 0.33",
        "IF E is NZ AND EC is PS THEN U is ZE, 0.33",
    ]
    for firing in explanation.firing:
        assert explanation.inference.strengths[firing.rule] == firing.strength
    assert explanation.inference.output == fuzzy.infer(controller, -0.2, 0.1).output
    # Each term of U is clipped at the strongest of its rules.
    assert dict(zip(controller.output.labels, explanation.term_strengths, strict=True)) == pytest.approx(
        {"NB": 0, "NM": 0, "NS": 0, "ZE": 0.1 / 0.28, "PS": 0, "PM": 0.2 / 0.3, "PB": 0}
    )


def centroid(polyline):
    """Of the area under straight lines: each contributes w (y0 + y1)/2 and w/6 (x0 (2 y0 + y1) + x1 (y0 + 2 y1))."""
    (x0, y0), (x1, y1) = polyline[:-1].T, polyline[1:].T
    w = x1 - x0
    return np.sum(w / 6 * (x0 * (2 * y0 + y1) + x1 * (y0 + 2 * y1))) / np.sum(w * (y0 + y1) / 2)


@pytest.mark.parametrize("widths", [fuzzy.InputWidths(), fuzzy.InputWidths(0.1, 0.5)])
def test_the_output_is_the_centroid_of_the_clipped_set(controller, widths):
    for e, ec in np.random.default_rng(2).uniform(-1.1, 1.1, (40, 2)):
        explanation = fuzzy.explain(controller, e, ec, widths)
        u = explanation.clipped[:, 0]
        assert (u[0], u[-1]) == (-1, 1) and np.all(np.diff(u) >= 0)
        assert explanation.clipped[:, 1].max() == pytest.approx(explanation.term_strengths.max(), abs=1e-12)
        assert centroid(explanation.clipped) == pytest.approx(explanation.inference.output, abs=1e-12)


def test_bells_are_drawn_with_enough_points_for_a_picture(gaussian_data):
    controller = make_controller(gaussian_data)
    for e, ec in np.random.default_rng(3).uniform(-1, 1, (20, 2)):
        explanation = fuzzy.explain(controller, e, ec)
        assert centroid(explanation.clipped) == pytest.approx(explanation.inference.output, abs=2e-3)


def test_nan_fires_nothing_and_clips_nothing(controller):
    explanation = fuzzy.explain(controller, math.nan, 0.0)
    assert math.isnan(explanation.inference.output)
    assert explanation.firing == []
    assert explanation.clipped.shape == (0, 2)
