"""Lines of pilotfish-coordinator --json."""

import json

import numpy as np
import pytest

from pilotfish.coordinator import telemetry_fields
from pilotfish.errors import HarnessError
from pilotfish.harness.frame_report import parse_reports

SEEN = dict.fromkeys(field.name for field in telemetry_fields()) | {
    "utime": 1033333,
    "status": "tracking",
    "reason": "",
    "detected": True,
    "distance_m": 2.44,
    "bearing_rad": -0.17,
    "heading_rad": 0.01,
    "reprojection_error_px": 0.1,
    "ambiguity_ratio": 1e6,
    "heading_ambiguity": 1e-9,
    "found_by": "track",
    "tag_ids": [0, 2],
    "decision_margins": [150.0, 90.0],
    "corners_px": [[[1, 2], [3, 2], [3, 0], [1, 0]], [[11, 2], [13, 2], [13, 0], [11, 0]]],
    "linear_mps": 0.2,
    "angular_radps": 0.0,
    "error_m": -1.34,
    "error_change_m": 0.0,
    "output": 0.9,
    "feed_forward_weight": 0.98,
    "leader_radial_mps": 0.2,
    "leader_tangential_mps": 0.0,
    "leader_turn_rate_radps": 0.01,
    "ego_motion": "commanded",
    "leader_intent": "silent",
    "latency_s": 0.003,
    "latency_from_exposure": False,
}
UNSEEN = (
    SEEN
    | dict.fromkeys(["distance_m", "bearing_rad", "heading_rad", "reprojection_error_px", "ambiguity_ratio"])
    | dict.fromkeys(["heading_ambiguity", "found_by"])
    | dict.fromkeys(["error_m", "error_change_m", "output", "feed_forward_weight", "ego_motion", "leader_intent"])
    | dict.fromkeys(["leader_radial_mps", "leader_tangential_mps", "leader_turn_rate_radps"])
    | {"detected": False, "tag_ids": [], "decision_margins": [], "corners_px": [], "status": "searching"}
)


def test_a_frame_with_two_tags_has_their_corners():
    (report,) = parse_reports([json.dumps(SEEN)])
    assert report.tag_ids == (0, 2)
    assert report.corners_px.shape == (2, 4, 2)
    np.testing.assert_array_equal(report.corners_px[1, 0], [11, 2])


def test_a_frame_without_the_leader_has_none_for_what_was_not_measured():
    (report,) = parse_reports([json.dumps(UNSEEN)])
    assert report.distance_m is None
    assert report.output is None
    assert report.corners_px.shape == (0, 4, 2)


def test_lines_that_are_no_objects_are_passed_over_and_a_last_line_cut_off_is_dropped():
    lines = ["12:00:00 ready", json.dumps(SEEN), json.dumps(UNSEEN), json.dumps(SEEN)[:50]]
    assert [report.detected for report in parse_reports(lines)] == [True, False]


def test_an_object_without_a_key_is_an_error_that_names_it():
    broken = {key: value for key, value in SEEN.items() if key != "bearing_rad"}
    with pytest.raises(HarnessError, match="bearing_rad"):
        parse_reports([json.dumps(broken)])
