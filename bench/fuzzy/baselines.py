"""The same controller in the baselines' own words: pyfuzzylite, scikit-fuzzy, and a table of values."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np

from pilotfish import fuzzy

RESOLUTION = 100  # fuzzylite's default; scikit-fuzzy gets as many intervals
Law = Callable[[np.ndarray, np.ndarray], np.ndarray]


def pyfuzzylite_law(controller: fuzzy.Controller) -> Law:
    """pyfuzzylite takes whole arrays; it reads the controller in FLL."""
    import fuzzylite

    engine = fuzzylite.FllImporter().from_string(fuzzy.to_fll(controller))
    engine.output_variables[0].defuzzifier.resolution = RESOLUTION
    error, change = engine.input_variables

    def law(e: np.ndarray, ec: np.ndarray) -> np.ndarray:
        error.value, change.value = e, ec
        engine.process()
        return engine.output_variables[0].value

    return law


def scikit_fuzzy_law(controller: fuzzy.Controller) -> Law:
    """scikit-fuzzy's control system on whole arrays, without its cache of earlier answers."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from skfuzzy import control

    def variable(kind: type, ours: fuzzy.LinguisticVariable) -> object:
        universe = np.linspace(ours.min, ours.max, RESOLUTION + 1)
        theirs = kind(universe, ours.name)
        for term in ours.terms:
            theirs[term.label] = fuzzy.membership(term.set, universe)
        return theirs

    error = variable(control.Antecedent, controller.error)
    change = variable(control.Antecedent, controller.error_change)
    output = variable(control.Consequent, controller.output)
    cells = controller.rules.consequents
    rules = [
        control.Rule(error[row] & change[column], output[controller.output.labels[cells[i, j]]])
        for i, row in enumerate(controller.error.labels)
        for j, column in enumerate(controller.error_change.labels)
    ]
    simulation = control.ControlSystemSimulation(control.ControlSystem(rules), cache=False)

    def law(e: np.ndarray, ec: np.ndarray) -> np.ndarray:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            simulation.input[controller.error.name] = e
            simulation.input[controller.error_change.name] = ec
            simulation.compute()
        return simulation.output[controller.output.name]

    return law


def table_law(controller: fuzzy.Controller, points: int = 257) -> Law:
    """A table of points x points exact values, interpolated bilinearly."""
    variables = (controller.error, controller.error_change)
    axes = [np.linspace(v.min, v.max, points) for v in variables]
    values = fuzzy.infer_outputs(controller, *(x.ravel() for x in np.meshgrid(*axes, indexing="ij")))
    values = values.reshape(points, points)

    def law(e: np.ndarray, ec: np.ndarray) -> np.ndarray:
        places = [
            (np.clip(x, v.min, v.max) - v.min) / (v.max - v.min) * (points - 1)
            for x, v in zip((e, ec), variables, strict=True)
        ]
        cells = [np.minimum(place.astype(int), points - 2) for place in places]
        (i, j), (s, t) = cells, (place - cell for place, cell in zip(places, cells, strict=True))
        low, high = (values[i + k, j] * (1 - t) + values[i + k, j + 1] * t for k in (0, 1))
        return low * (1 - s) + high * s

    return law
