"""The shipped controller against fuzzylite 6, over the whole grid of inputs.

fuzzylite samples its centroid (midpoint rule), so it is refined until it agrees with itself first. What
remains between two resolutions is a bound on its own error, and we have to be inside it.
"""

import numpy as np
from fuzzy_builders import make_controller

from pilotfish import fuzzy


def compare(fuzzylite, controller, e, ec, agreement):
    coarse, resolution = fuzzylite.outputs(controller, e, ec, 1024), 1024
    while True:
        resolution *= 4
        fine = fuzzylite.outputs(controller, e, ec, resolution)
        assert np.all(np.isfinite(fine))
        own_error = np.abs(fine - coarse).max()
        if own_error < agreement:
            break
        assert resolution < 100_000, f"fuzzylite does not agree with itself: {own_error}"
        coarse = fine
    ours, _ = fuzzy.infer_batch(controller, e, ec)
    difference = np.abs(ours - fine).max()
    assert difference < own_error, f"|du| = {difference:.1e}, fuzzylite's own error is {own_error:.1e}"


def test_the_whole_grid_of_inputs_agrees_with_fuzzylite(fuzzylite, controller):
    # 47 x 41 points from below to above the universes, off the knees; both ends saturate.
    e, ec = (x.ravel() for x in np.meshgrid(np.linspace(-1.13, 1.1, 47), np.linspace(-1.07, 1.2, 41), indexing="ij"))
    compare(fuzzylite, controller, e, ec, agreement=2e-6)


def test_the_corner_points_of_all_sets_agree_with_fuzzylite(fuzzylite, controller, data):
    def corners(name):
        points = {x for spec in data[name]["terms"].values() for p in spec.values() for x in p if np.isfinite(x)}
        return sorted(points | {0.0})

    e, ec = (x.ravel() for x in np.meshgrid(corners("E"), corners("EC"), indexing="ij"))
    compare(fuzzylite, controller, e, ec, agreement=2e-6)


def test_gaussian_sets_agree_with_fuzzylite(fuzzylite, gaussian_data):
    e, ec = np.random.default_rng(5).uniform(-1.1, 1.1, (2, 300))
    compare(fuzzylite, make_controller(gaussian_data), e, ec, agreement=2e-6)
