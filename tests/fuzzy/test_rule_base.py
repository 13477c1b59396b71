"""What a controller made in Python has to validate."""

import numpy as np
import pytest

from pilotfish import fuzzy


def variant(controller, **changes):
    parts = {name: getattr(controller, name) for name in ("error", "error_change", "output", "rules")}
    return fuzzy.Controller(**{**parts, **changes})


def test_a_rule_reads_as_a_sentence(controller):
    # Row NS is the third, column ZE the fourth: rule 2 * 7 + 3.
    assert fuzzy.describe_rule(controller, 17) == "IF E is NS AND EC is ZE THEN U is PM"
    assert fuzzy.describe_rule(controller, 0) == "IF E is NB AND EC is NB THEN U is PB"
    assert fuzzy.describe_rule(controller, 55) == "IF E is PB AND EC is PB THEN U is NB"
    with pytest.raises(IndexError):
        fuzzy.describe_rule(controller, 56)


@pytest.mark.parametrize("shape", [(7, 8), (6, 9), (8, 6), (1, 56), (0, 0)])
def test_a_table_of_another_shape_is_refused(controller, shape):
    table = fuzzy.RuleBase(np.zeros(shape, dtype=int).tolist())
    with pytest.raises(ValueError, match=rf"^rules: has {shape[0] * shape[1]} cells"):
        variant(controller, rules=table)


def test_a_consequent_that_is_no_term_is_refused_with_its_cell(controller):
    table = controller.rules.consequents
    table[3, 5] = 7
    with pytest.raises(ValueError, match=r"^rules\.NZ\.PM: 7 is not the index of a term of U, which has 7"):
        variant(controller, rules=fuzzy.RuleBase(table.tolist()))


def test_rows_of_different_lengths_are_refused():
    with pytest.raises(ValueError, match="different lengths"):
        fuzzy.RuleBase([[0, 1], [0]])


def test_swapped_inputs_are_refused(controller):
    with pytest.raises(ValueError, match=r"^EC\.terms: has 7 terms; the rule base needs 8"):
        variant(controller, error=controller.error_change, error_change=controller.error)


def test_more_terms_than_inference_has_room_for_are_refused():
    terms = [fuzzy.Term(f"T{i}", fuzzy.Triangle(-1, 0, 1)) for i in range(17)]
    fuzzy.LinguisticVariable("U", terms[:16])
    with pytest.raises(ValueError, match=r"^U\.terms: has 17 terms; 1 to 16 are possible"):
        fuzzy.LinguisticVariable("U", terms)
    with pytest.raises(ValueError, match=r"^U\.terms: has 0 terms"):
        fuzzy.LinguisticVariable("U", [])


def test_a_label_twice_or_none_is_refused():
    shape = fuzzy.Triangle(-1, 0, 1)
    with pytest.raises(ValueError, match=r"^U\.terms\.A: is there twice"):
        fuzzy.LinguisticVariable("U", [fuzzy.Term("A", shape), fuzzy.Term("A", shape)])
    with pytest.raises(ValueError, match=r"^U\.terms: has a term without a label"):
        fuzzy.LinguisticVariable("U", [fuzzy.Term("", shape)])


def test_coverage_just_above_the_limit_passes_and_just_below_is_refused(controller):
    # ZE falls from 0 to h, PS rises from 0.6 - h to 0.6: mirror images about 0.3, where both have 1 - 0.3/h.
    def with_meeting_degree(y):
        h = 0.3 / (1 - y)
        old = {term.label: term.set for term in controller.error_change.terms}
        sets = {
            "NB": old["NB"], "NM": old["NM"], "NS": old["NS"], "ZE": fuzzy.Triangle(-0.3, 0, h),
            "PS": fuzzy.Triangle(0.6 - h, 0.6, 0.7), "PM": fuzzy.Triangle(0.6, 0.7, 1.0), "PB": old["PB"],
        }  # fmt: skip
        return fuzzy.LinguisticVariable("EC", [fuzzy.Term(label, s) for label, s in sets.items()])

    variant(controller, error_change=with_meeting_degree(0.0011))
    with pytest.raises(ValueError, match=r"^EC\.terms: no term covers 0\.3 well: the greatest degree there is 0\.0009"):
        variant(controller, error_change=with_meeting_degree(0.0009))


@pytest.mark.parametrize(
    ("label", "ends_at_once", "where"),
    [("PS", fuzzy.Triangle(0.0, 0.3, 0.3), "0.3"), ("NS", fuzzy.Triangle(-0.3, -0.3, 0.0), "-0.3")],
)
def test_a_gap_beside_a_vertical_side_is_refused(controller, label, ends_at_once, where):
    # At 0.3 PS is one, and just behind it nothing: ZE has come down to zero, PM begins to rise. So only the beginning
    # of the arc from 0.3 on shows the gap, and of its mirror image only the end of the arc up to -0.3.
    terms = [fuzzy.Term(t.label, ends_at_once if t.label == label else t.set) for t in controller.error_change.terms]
    with pytest.raises(ValueError, match=rf"^EC\.terms: no term covers {where} well: the greatest degree there is 0,"):
        variant(controller, error_change=fuzzy.LinguisticVariable("EC", terms))


def test_the_far_side_of_a_gaussian_does_not_count_as_coverage(controller):
    # Between Gaussians of sigma 0.01 at -0.3 and 0 the degree at -0.15 is exp(-15^2/2) = 1e-49, far too weak.
    terms = [fuzzy.Term(t.label, t.set) for t in controller.error_change.terms]
    terms[2] = fuzzy.Term("NS", fuzzy.Gaussian(-0.3, 0.01))
    terms[3] = fuzzy.Term("ZE", fuzzy.Gaussian(0.0, 0.01))
    with pytest.raises(ValueError, match=r"^EC\.terms: no term covers -0\.15 well: the greatest degree there is"):
        variant(controller, error_change=fuzzy.LinguisticVariable("EC", terms))
