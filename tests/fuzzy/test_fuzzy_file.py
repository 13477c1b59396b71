"""data/fuzzy/*.yaml: what is shipped loads, and every broken file is refused with the place of the defect."""

import math
import re

import numpy as np
import pytest
import yaml
from fuzzy_builders import make_controller

from pilotfish import fuzzy

TABLE_1 = """
NB PB PB PB PB PM PM PM
NM PB PB PM PM PM PM PM
NS PM PM PM PM PM PM PS
NZ PS PS ZE ZE ZE ZE NS
PZ PS ZE ZE ZE ZE NS NS
PS NS NS NM NM NM NM NM
PM NS NM NM NM NM NM NB
PB NM NB NB NB NB NB NB
"""  # the source paper's, columns NB NM NS ZE PS PM PB of EC


def test_the_shipped_rules_are_the_papers_table(controller):
    rows = [line.split() for line in TABLE_1.strip().splitlines()]
    labels = controller.output.labels
    assert controller.error.labels == [row[0] for row in rows]
    assert controller.error_change.labels == ["NB", "NM", "NS", "ZE", "PS", "PM", "PB"]
    assert labels == ["NB", "NM", "NS", "ZE", "PS", "PM", "PB"]
    assert [[labels[k] for k in row] for row in controller.rules.consequents] == [row[1:] for row in rows]


def test_the_file_and_the_bindings_build_the_same_controller(controller, data):
    twin = make_controller(data)
    e, ec = np.random.default_rng(1).uniform(-1.1, 1.1, (2, 500))
    for ours, theirs in zip(fuzzy.infer_batch(controller, e, ec), fuzzy.infer_batch(twin, e, ec), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_a_file_of_gaussians_loads(gaussian_data, tmp_path):
    file = tmp_path / "gaussians.yaml"
    file.write_text(yaml.safe_dump(gaussian_data, sort_keys=False))
    from_file, twin = fuzzy.load_controller(file), make_controller(gaussian_data)
    assert fuzzy.infer(from_file, 0.21, -0.1).output == fuzzy.infer(twin, 0.21, -0.1).output


def put(*path_and_value):
    """A defect: data[path[0]][path[1]]... = value."""
    *path, last, value = path_and_value

    def apply(data):
        for key in path:
            data = data[key]
        data[last] = value

    return apply


def drop(*path):
    *path, last = path

    def apply(data):
        for key in path:
            data = data[key]
        del data[last]

    return apply


def replace_terms(variable, first, second):
    """Two terms of a variable get new sets."""

    def apply(data):
        data[variable]["terms"].update(dict([first, second]))

    return apply


def without_pb_column(data):
    data["rules"]["columns"] = data["rules"]["columns"][:-1]
    data["EC"]["terms"].pop("PB")
    data["EC"]["terms"]["PM"] = {"trapezoid": [0.3, 0.6, math.inf, math.inf]}
    for row in data["E"]["terms"]:
        data["rules"][row] = data["rules"][row][:-1]


ROW_NB = ["PB", "PB", "PB", "PB", "PM", "PM", "PM"]
DEFECTS = {
    "an unknown label in a cell": (
        put("rules", "NB", [*ROW_NB[:4], "XX", *ROW_NB[5:]]),
        "rules.NB.PS: 'XX' is not a term of U; terms: NB, NM, NS, ZE, PS, PM, PB",
    ),
    "54 cells, two missing in one row": (
        put("rules", "PZ", ROW_NB[:5]),
        "rules.PZ: has 5 cells; one for each of the 7 columns",
    ),
    "57 cells": (put("rules", "PZ", [*ROW_NB, "PB"]), "rules.PZ: has 8 cells"),
    "a row missing": (drop("rules", "NM"), "rules.NM: is missing"),
    "a row too many": (put("rules", "XX", ROW_NB), "rules.XX: is not a known key"),
    "a complete table of 48 cells": (without_pb_column, "EC.terms: has 6 terms; the rule base needs 7"),
    "columns in another order": (
        put("rules", "columns", ["PB", "NM", "NS", "ZE", "PS", "PM", "NB"]),
        "rules.columns: must be the terms of EC in their order: NB, NM, NS, ZE, PS, PM, PB",
    ),
    "a hole in a universe": (
        put("E", "terms", "PM", {"triangle": [0.55, 0.6, 0.8]}),
        "E.terms: no term covers 0.5 ",  # PS ends at 0.5 and PB begins there
    ),
    "an interval that no term covers": (
        replace_terms("EC", ("NM", {"triangle": [-1.0, -0.6, -0.4]}), ("NS", {"triangle": [-0.25, -0.2, 0.0]})),
        "EC.terms: no term covers -0.4 to -0.3",
    ),
    "a gap behind a vertical side": (
        replace_terms(
            "EC", ("PM", {"triangle": [0.3, 0.5, 0.5]}), ("PB", {"trapezoid": [0.7, 1.0, math.inf, math.inf]})
        ),
        "EC.terms: no term covers 0.6 to 0.7",
    ),
    "a set outside its universe": (
        put("E", "terms", "PB", {"triangle": [1.0, 1.5, 2.0]}),
        "E.terms.PB: has no area inside the universe [-1, 1]",
    ),
    "an output set outside its universe": (
        put("U", "terms", "NB", {"triangle": [-3, -2, -1]}),
        "U.terms.NB: has no area inside the universe [-1, 1]",
    ),
    "a number that is not one": (
        put("E", "terms", "NM", {"triangle": [math.nan, -0.5, -0.3]}),
        "E.terms.NM: a <= b <= c is violated: nan, -0.5, -0.3",
    ),
    "a word for a number": (
        put("E", "terms", "NM", {"triangle": ["x", -0.5, -0.3]}),
        "E.terms.NM.triangle: 'x' is not a number",
    ),
    "corners in the wrong order": (
        put("U", "terms", "PM", {"triangle": [0.6, 0.3, 0.9]}),
        "U.terms.PM: a <= b <= c is violated: 0.6, 0.3, 0.9",
    ),
    "a trapezoid of three corners": (
        put("U", "terms", "PM", {"trapezoid": [0.3, 0.6, 0.9]}),
        "U.terms.PM.trapezoid: needs 4 numbers, got 3",
    ),
    "an unknown shape": (
        put("U", "terms", "PM", {"sigmoid": [1, 2]}),
        "U.terms.PM.shape: is missing: one of triangle",
    ),
    "two shapes for one term": (
        put("U", "terms", "PM", {"triangle": [0.3, 0.6, 0.9], "gaussian": {"mean": 0, "sigma": 1}}),
        "U.terms.PM.gaussian: is not a known key",
    ),
    "a gaussian without width": (
        put("U", "terms", "PM", {"gaussian": {"mean": 0.5, "sigma": 0.0}}),
        "U.terms.PM: 0 < sigma < inf is violated: 0",
    ),
    "a gaussian with a key too many": (
        put("U", "terms", "PM", {"gaussian": {"mean": 0.5, "sigma": 0.1, "skew": 1}}),
        "U.terms.PM.gaussian.skew: is not a known key",
    ),
    "an unknown key": (put("defuzzifier", "centroid"), "defuzzifier: is not a known key"),
    "an unknown key of a variable": (put("E", "unit", "m"), "E.unit: is not a known key"),
    "a variable missing": (drop("EC"), "EC: is missing"),
    "a universe that is empty": (
        put("U", "universe", [1.0, 1.0]),
        "U.universe: [1, 1] is not a finite interval",
    ),
    "a universe without end": (
        put("U", "universe", [-1.0, math.inf]),
        "U.universe: [-1, inf] is not a finite interval",
    ),
    "a universe of one number": (put("U", "universe", [1.0]), "U.universe: needs two numbers"),
}


@pytest.mark.parametrize(("defect", "message"), DEFECTS.values(), ids=DEFECTS.keys())
def test_a_broken_file_is_refused_with_the_place_of(defect, message, data, tmp_path):
    defect(data)
    file = tmp_path / "broken.yaml"
    file.write_text(yaml.safe_dump(data, sort_keys=False))
    with pytest.raises(ValueError, match="^" + re.escape(message)) as refusal:
        fuzzy.load_controller(file)
    assert str(file) in str(refusal.value)


def test_a_term_given_twice_is_refused(data, tmp_path):
    file = tmp_path / "twice.yaml"
    text = yaml.safe_dump(data, sort_keys=False)
    file.write_text(text.replace("    NM:\n", "    NB:\n", 1))
    with pytest.raises(ValueError, match=r"^E\.terms\.NB: is (given|there) twice"):
        fuzzy.load_controller(file)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(ValueError, match="cannot read"):
        fuzzy.load_controller(tmp_path / "nothing.yaml")
