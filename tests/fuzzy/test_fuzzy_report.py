"""What `pilotfish fuzzy` finds out about a controller, on controllers of which it is known."""

import pytest
from fuzzy_builders import make_controller

from pilotfish.fuzzy_report import analyse


def test_the_shipped_controller_has_nothing_to_find(controller):
    report = analyse(controller)
    assert report.findings == []
    assert report.dead_zone == (0.0, 0.0)
    # test_coordination_surface.py derives these: the slope at zero, the reach, the ripple.
    assert report.slope_at_zero == pytest.approx((-2.786, -2.786), abs=1e-3)
    assert report.range == pytest.approx((-11 / 12, 11 / 12))
    assert report.ripple == pytest.approx((0.0308, 0.0355), abs=1e-3)
    assert report.jumps == []


def test_peaks_of_nz_and_pz_at_a_tenth_are_a_dead_zone_as_wide(data):
    # NS and PS begin at the peaks; between them only NZ and PZ fire, and both say ZE.
    data["E"]["terms"] |= {
        "NS": {"triangle": [-0.5, -0.3, -0.1]}, "NZ": {"triangle": [-0.3, -0.1, 0.1]},
        "PZ": {"triangle": [-0.1, 0.1, 0.3]}, "PS": {"triangle": [0.1, 0.3, 0.5]},
    }  # fmt: skip
    report = analyse(make_controller(data))
    assert report.dead_zone == pytest.approx((-0.1, 0.1), abs=1e-5)
    assert report.slope_at_zero == pytest.approx((0, 0), abs=1e-9)
    assert any(finding.startswith("dead zone: u(e, 0) stays zero from e = -0.1 to 0.1") for finding in report.findings)


def test_a_vertical_side_is_a_discontinuity(data):
    # NM ends at once where it is one, at -0.5, and NS begins there. Where EC is NM alone (-0.6), PB alone, 11/12,
    # becomes PM alone, 0.6; nowhere else do the two rows differ more.
    data["E"]["terms"]["NM"] = {"triangle": [-0.8, -0.5, -0.5]}
    data["E"]["terms"]["NS"] = {"trapezoid": [-0.5, -0.5, -0.3, 0.0]}
    (jump,) = analyse(make_controller(data)).jumps
    assert (jump.variable, jump.at) == ("E", -0.5)
    assert jump.size == pytest.approx(11 / 12 - 0.6)


def test_a_rule_that_another_always_outdoes_is_named(data):
    # NZ lies within PZ: whatever they both conclude, PZ says at least as strongly.
    data["E"]["terms"]["NZ"] = {"triangle": [-0.1, -0.02, 0.05]}
    data["E"]["terms"]["PZ"] = {"trapezoid": [-0.3, -0.1, 0.05, 0.3]}
    data["rules"]["NZ"] = data["rules"]["PZ"]
    report = analyse(make_controller(data))
    assert [rule for rule in report.never_decides if "E is NZ" in rule] == report.never_decides
    assert len(report.never_decides) == 7
    assert report.never_fires == []


def test_a_mirrored_controller_has_the_mirrored_report(data):
    def mirrored(spec):
        ((shape, p),) = spec.items()
        return {shape: [-x for x in reversed(p)]}

    original = analyse(make_controller(data))
    for name in ("E", "EC", "U"):
        terms = data[name]["terms"]
        data[name]["terms"] = {label: mirrored(spec) for label, spec in reversed(terms.items())}
    data["rules"] = {"columns": data["rules"]["columns"][::-1]} | {
        row: cells[::-1] for row, cells in data["rules"].items() if row != "columns"
    }
    mirror = analyse(make_controller(data))
    assert mirror.slope_at_zero == pytest.approx(original.slope_at_zero[::-1])
    assert mirror.range == pytest.approx((-original.range[1], -original.range[0]))
    assert mirror.ripple == pytest.approx(original.ripple)
