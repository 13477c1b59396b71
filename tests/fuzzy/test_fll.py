"""fuzzylite's language: what we write, fuzzylite reads and writes again; what we do not do is refused with its line."""

import math

import fuzzy_reference
import numpy as np
import pytest
from fuzzy_builders import make_controller
from hypothesis import given, settings
from hypothesis import strategies as st
from test_mamdani import controllers

from pilotfish import fuzzy

SHIPPED = fuzzy_reference.DATA


def load(tmp_path, text, suffix=".fll"):
    file = tmp_path / f"controller{suffix}"
    file.write_text(text)
    return fuzzy.load_controller(file)


def assert_same(ours, theirs):
    """Every set and every cell, to the last digit; so every output as well."""
    assert fuzzy.to_fll(ours) == fuzzy.to_fll(theirs)
    e, ec = np.random.default_rng(5).uniform(-1.2, 1.2, (2, 100))
    np.testing.assert_array_equal(fuzzy.infer_outputs(ours, e, ec), fuzzy.infer_outputs(theirs, e, ec))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("round_trips")


@settings(derandomize=True, deadline=None, max_examples=40)
@given(data=controllers())
@pytest.mark.parametrize(("write", "suffix"), [(fuzzy.to_fll, ".fll"), (fuzzy.to_yaml, ".yaml")], ids=["fll", "yaml"])
def test_any_controller_survives_a_round_trip_to_the_last_digit(folder, write, suffix, data):
    controller = make_controller(data)
    again = load(folder, write(controller), suffix)
    assert again.name == controller.name
    assert_same(again, controller)


def test_the_shipped_controller_survives_fuzzylite_s_own_import_and_export(fuzzylite, controller, tmp_path):
    exported = fuzzylite.exported(controller)
    assert "activation: General" in exported  # it is fuzzylite that wrote this, not we
    assert exported != fuzzy.to_fll(controller)
    assert_same(load(tmp_path, exported), controller)


@settings(derandomize=True, deadline=None, max_examples=10)
@given(data=controllers())
def test_any_controller_survives_fuzzylite_s_own_import_and_export(fuzzylite, folder, data):
    # fuzzylite writes 17 places behind the point; of numbers of this size that is every digit but the last.
    controller = make_controller(data)
    again = load(folder, fuzzylite.exported(controller))
    e, ec = np.random.default_rng(6).uniform(-1.2, 1.2, (2, 100))
    np.testing.assert_allclose(
        fuzzy.infer_outputs(again, e, ec), fuzzy.infer_outputs(controller, e, ec), rtol=0, atol=1e-12
    )


def replaced(old, new):
    """The shipped controller in FLL with one line in another wording."""
    text = fuzzy.to_fll(fuzzy.load_controller(SHIPPED))
    assert text.count(old) >= 1
    return text.replace(old, new, 1)


EQUIVALENT = {
    "a ramp for a right shoulder": ("PB Trapezoid 0.5 0.8 inf inf", "PB Ramp 0.5 0.8"),
    "a ramp that falls for a left shoulder": ("NB Trapezoid -inf -inf -0.8 -0.5", "NB Ramp -0.5 -0.8"),
    "a trapezoid with one open corner": ("PB Trapezoid 0.5 0.8 inf inf", "PB Trapezoid 0.5 0.8 0.9 inf"),
    "a triangle with an open corner": ("PB Trapezoid 0.5 0.8 inf inf", "PB Triangle 0.5 0.8 inf"),
    "a height of one": ("NM Triangle -0.8 -0.5 -0.3", "NM Triangle -0.800 -0.500 -0.300 1.000"),
    "the inputs of a rule the other way round": (
        "if E is NB and EC is NM then",
        "if EC is NM and E is NB then",
    ),
    "a weight of one": ("EC is NB then U is PB", "EC is NB then U is PB with 1.000"),
    "comments and blank lines": ("RuleBlock: table", "\n# the table\nRuleBlock: table # of the paper"),
    "descriptions": ("RuleBlock: table", "RuleBlock:\n  description: 56 rules: all of them"),
    "another default": ("default: nan", "default: 0.000"),
    "another resolution": ("Centroid 1000", "Centroid 100"),
    "a plus sign": ("PB Trapezoid 0.5 0.8", "PB Trapezoid +0.5 +0.8"),
    "a range that is not locked, where that changes nothing": ("lock-range: true", "lock-range: false"),
}


@pytest.mark.parametrize(("old", "new"), EQUIVALENT.values(), ids=EQUIVALENT.keys())
def test_the_same_controller_in_other_words_to_us_and_to_fuzzylite(controller, fuzzylite, tmp_path, old, new):
    text = replaced(old, new)
    same = load(tmp_path, text)
    e, ec = np.random.default_rng(7).uniform(-1.2, 1.2, (2, 200))
    np.testing.assert_array_equal(fuzzy.infer_outputs(same, e, ec), fuzzy.infer_outputs(controller, e, ec))
    if "Centroid" not in new:  # sampled alike, fuzzylite agrees with itself to rounding
        theirs = [fuzzylite.outputs(law, e, ec, 1000) for law in (controller, text)]
        np.testing.assert_allclose(*theirs, rtol=0, atol=1e-12)


def test_rectangles_and_binaries_are_boxes_and_steps(fuzzylite, tmp_path):
    text = replaced("NB Trapezoid -inf -inf -0.8 -0.5", "NB Binary -0.5 -inf")
    text = text.replace("PS Triangle 0 0.3 0.5", "PS Rectangle 0 0.5")
    controller = load(tmp_path, text)
    assert [fuzzy.membership(controller.error.terms[0].set, x) for x in (-0.6, -0.5, -0.4)] == [1, 1, 0]
    assert [fuzzy.membership(controller.error.terms[5].set, x) for x in (-0.1, 0.0, 0.4, 0.5, 0.6)] == [0, 1, 1, 1, 0]
    e, ec = np.random.default_rng(8).uniform(-1, 1, (2, 300))
    theirs = fuzzylite.outputs(text, e, ec, 8192)  # its sampling is off by about 1e-7 then
    np.testing.assert_allclose(fuzzy.infer_outputs(controller, e, ec), theirs, rtol=0, atol=1e-6)


# HERE is the line that was changed, NEXT the one below it, BLOCK the heading of the rule block.
REFUSED = {
    "a shape we do not have": ("PS Triangle 0 0.3 0.5", "PS Bell 0.3 0.2 3", r"line HERE: term 'PS': Bell is not supp"),
    "a height": ("PS Triangle 0 0.3 0.5", "PS Triangle 0 0.3 0.5 0.8", r"line HERE: term 'PS': height 0\.8 is not"),
    "too few numbers": (
        "PS Triangle 0 0.3 0.5",
        "PS Triangle 0 0.3",
        r"line HERE: term 'PS': Triangle needs 3 numbers",
    ),
    "a word for a number": ("PS Triangle 0 0.3 0.5", "PS Triangle 0 x 0.5", r"line HERE: 'x' is not a number"),
    "corners in the wrong order": (
        "PS Triangle 0 0.3 0.5",
        "PS Triangle 0.3 0 0.5",
        r"line HERE: term 'PS': a <= b <= c",
    ),
    "a ramp without direction": ("PS Triangle 0 0.3 0.5", "PS Ramp 0.3 0.3", r"line HERE: term 'PS': a Ramp from a"),
    "a term without a shape": ("PS Triangle 0 0.3 0.5", "PS", r"line HERE: a term needs a name and a shape"),
    "another conjunction": ("conjunction: Minimum", "conjunction: AlgebraicProduct", r"conjunction 'AlgebraicProduct'"),
    "no conjunction": ("  conjunction: Minimum\n", "", r"needs  conjunction: Minimum"),
    "another implication": ("implication: Minimum", "implication: AlgebraicProduct", r"implication 'AlgebraicPro"),
    "another aggregation": ("aggregation: Maximum", "aggregation: AlgebraicSum", r"aggregation 'AlgebraicSum' is not"),
    "another defuzzifier": ("Centroid 1000", "Bisector 1000", r"defuzzifier 'Bisector 1000' is not supported"),
    "no defuzzifier": ("  defuzzifier: Centroid 1000\n", "", r"needs  defuzzifier: Centroid"),
    "another activation": ("activation: General", "activation: First 1 0.5", r"activation 'First 1 0\.5' is not"),
    "a block that is off": ("  enabled: true", "  enabled: false", r"line HERE: enabled 'false' is not supported"),
    "a weight": ("EC is NB then U is PB", "EC is NB then U is PB with 0.5", r"is not of the form .*no weights"),
    "a hedge": ("if E is NB and", "if E is very NB and", r"line HERE: 'if E is very NB"),
    "an or": ("if E is NB and EC", "if E is NB or EC", r"line HERE: 'if E is NB or EC"),
    "a term that is not there": (
        "if E is NB and",
        "if E is XX and",
        r"line HERE: 'XX' is not a term of E; terms: NB, ",
    ),
    "a rule twice": (
        "EC is NM then U is PB",
        "EC is NB then U is PB",
        r"line HERE: there is already a rule for E NB and",
    ),
    "a rule missing": (
        "  rule: if E is NB and EC is NM then U is PB\n",
        "",
        r"line BLOCK: there is no rule for E NB and EC NM",
    ),
    "an unknown key": ("  range: -1 1", "  range: -1 1\n  unit: m", r"line NEXT: 'unit' is not a key of InputVariable"),
    "a line without a key": ("RuleBlock: table", "what", r"line HERE: 'what' is not of the form  key: value"),
    "a third input": ("OutputVariable: U", "InputVariable: X\n  range: 0 1\nOutputVariable: U", r"more than two Input"),
    "no range": ("  range: -1 1\n", "", r"line 2: E has no range"),
    "a term twice": ("term: NM Triangle", "term: NB Triangle", r"^E\.terms\.NB: is there twice"),
    "a hole": ("PM Triangle 0.3 0.5 0.8", "PM Triangle 0.55 0.6 0.8", r"^E\.terms: no term covers 0\.5 "),
    "an input that is not locked and has Gaussians": (
        "lock-range: true\n  term: NB Trapezoid -inf -inf -0.8 -0.5",
        "lock-range: false\n  term: NB Gaussian -1 0.3",
        r"line HERE: lock-range is false, but term 'NB' of E changes outside the range",
    ),
}


@pytest.mark.parametrize(("old", "new", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_we_do_not_do_is_refused_with_its_line(tmp_path, old, new, message):
    text = replaced(old, new)
    here = replaced(old, "@@").split("@@")[0].count("\n") + 1
    block = text[: text.find("RuleBlock")].count("\n") + 1
    for word, line in (("HERE", here), ("NEXT", here + 1), ("BLOCK", block)):
        message = message.replace(word, str(line))
    with pytest.raises(ValueError, match=message) as refusal:
        load(tmp_path, text)
    assert "controller.fll" in str(refusal.value)


@pytest.mark.parametrize("text", ["", "Engine: empty\n", "InputVariable: E\n  range: 0 1\n  term: A Ramp 0 1\n"])
def test_half_a_controller_is_refused(tmp_path, text):
    with pytest.raises(ValueError, match="two InputVariables are needed"):
        load(tmp_path, text)


@settings(derandomize=True, deadline=None, max_examples=150)
@given(cut=st.integers(0, 4200), noise=st.text(alphabet=":#- \n.0infrule", max_size=8))
def test_a_file_cut_short_or_scribbled_on_is_refused_or_read_but_never_worse(folder, cut, noise):
    text = fuzzy.to_fll(fuzzy.load_controller(SHIPPED))
    try:
        controller = load(folder, text[:cut] + noise + text[cut + 1 :] if cut % 2 else text[:cut])
    except ValueError:
        return
    assert math.isfinite(fuzzy.infer(controller, 0.1, 0.2).output)


def test_a_name_that_fll_cannot_say_is_refused(data):
    data["U"]["terms"] = {("PB fast" if k == "PB" else k): v for k, v in data["U"]["terms"].items()}
    data["rules"] = {
        k: ["PB fast" if c == "PB" else c for c in v] if k != "columns" else v for k, v in data["rules"].items()
    }
    with pytest.raises(ValueError, match="PB fast: is not a name in FLL"):
        fuzzy.to_fll(make_controller(data))


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(ValueError, match="cannot read"):
        fuzzy.load_controller(tmp_path / "nowhere.fll")


def test_a_coordinator_takes_its_law_from_fll(controller, tmp_path):
    from pilotfish import coordinator
    from pilotfish import data as shipped

    (tmp_path / "law.fll").write_text(fuzzy.to_fll(controller))
    text = shipped.path("config/line.yaml").read_text()
    folder = shipped.path("config/line.yaml").parent
    config = tmp_path / "line.yaml"
    lines = []
    for line in text.splitlines():
        key, _, value = line.partition(":")
        if key.strip() == "fuzzy":
            line = "fuzzy: law.fll"
        elif ".yaml" in value or ".xml" in value:
            name = value.split("#")[0].strip()
            line = line.replace(name, str((folder / name).resolve()))
        lines.append(line)
    config.write_text("\n".join(lines))
    law = coordinator.load_coordinator(config).coordinator.control.law
    assert_same(law, controller)
