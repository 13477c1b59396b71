"""What is reported of a frame is described once: names, units, texts and where the values are."""

import numpy as np
import pytest

from pilotfish import bus, core
from pilotfish import data as shipped
from pilotfish.coordinator import Coordinator, load_coordinator, step_values, telemetry_fields
from pilotfish.core import Reason
from pilotfish.harness.frame_report import FrameReport

CONFIG = load_coordinator(str(shipped.path("config/line.yaml"))).coordinator

UNITS = {
    "m": "m",
    "rad": "rad",
    "px": "px",
    "mps": "m/s",
    "radps": "rad/s",
    "s": "s",
    "ms": "ms",
    "hz": "Hz",
}  # what a name ends with, by docs/conventions.md


def all_rows():
    yield from ((field.name, field.unit, field.text) for field in telemetry_fields())
    yield from ((name, unit, text) for name, _, unit, text in bus.status_fields())


@pytest.mark.parametrize(("name", "unit", "text"), sorted(set(all_rows())))
def test_a_field_says_what_it_is_and_its_name_carries_its_unit(name, unit, text):
    assert text
    _, _, ending = name.rpartition("_")
    if ending in UNITS and ending != name:
        assert unit == UNITS[ending]
    else:
        assert unit not in set(UNITS.values()), "its name should end with the unit"


def test_no_name_occurs_twice():
    names = [field.name for field in telemetry_fields()]
    assert len(set(names)) == len(names)


def test_of_a_frame_the_bus_says_nothing_that_a_json_line_does_not():
    """The rest of a status is of the program: its session, its counters, its rates."""
    of_the_program = {"session", "setpoint_counter", "frame_rate_hz", "processing_ms"}
    of_the_program |= {"configured_latency_s", "missed_deadlines", "clock_epochs"}
    reported = [field.name for field in telemetry_fields()]
    of_a_frame = [name for name, _, _, _ in bus.status_fields() if name not in of_the_program]
    assert of_a_frame == [name for name in reported if name in of_a_frame]


OBSERVATION = core.Observation(
    utime=7,
    distance_m=1.5,
    bearing_rad=-0.25,
    heading_rad=0.125,
    covariance=np.diag([1e-6, 1e-6, 1e-4]),
    found_by=core.FoundBy.region,
    heading_ambiguity=0.5,
    tags=[core.TagDetection(id=3, corners_px=np.arange(8.0).reshape(4, 2), decision_margin=42.5)],
)


def test_of_a_step_the_values_are_those_of_its_parts():
    result = Coordinator(CONFIG).step_observation(7, OBSERVATION, 7)
    said = step_values(result)
    assert list(said) == [field.name for field in telemetry_fields()]
    assert (said["utime"], said["status"], said["reason"], said["detected"]) == (7, "tracking", "", True)
    assert (said["distance_m"], said["bearing_rad"], said["heading_rad"]) == (1.5, -0.25, 0.125)
    assert (said["found_by"], said["heading_ambiguity"]) == ("region", 0.5)
    assert (said["tag_ids"], said["decision_margins"]) == ([3], [42.5])
    assert said["corners_px"] == [[[0, 1], [2, 3], [4, 5], [6, 7]]]
    assert (said["linear_mps"], said["angular_radps"]) == (result.command.linear_mps, result.command.angular_radps)
    law = result.control.velocity
    assert (said["error_m"], said["error_change_m"], said["output"]) == (
        law.error_m,
        law.error_change_m,
        law.inference.output,
    )
    assert said["feed_forward_weight"] == result.control.feed_forward_weight
    assert (said["ego_motion"], said["leader_intent"]) == ("commanded", "silent")
    assert (said["latency_s"], said["latency_from_exposure"]) == (None, False)  # not measured


def test_of_a_step_that_saw_nothing_there_is_what_always_is_and_none():
    said = step_values(Coordinator(CONFIG).step_observation(7, None, 7))
    assert (said["status"], said["reason"]) == ("searching", Reason.no_tag_found.text)
    always = {"utime", "status", "reason", "detected", "tag_ids", "decision_margins", "corners_px"}
    always |= {"linear_mps", "angular_radps", "latency_from_exposure", "leader_index", "leader_changes"}
    assert {name for name, value in said.items() if value is not None} == always
    report = FrameReport.from_step(Coordinator(CONFIG).step_observation(7, None, 7))
    assert (report.distance_m, report.tag_ids, report.corners_px.shape) == (None, (), (0, 4, 2))
    assert repr(report).startswith("FrameReport(utime=7, status='searching', reason='no tag")


def test_a_frame_report_says_of_every_field_what_it_is():
    for field in telemetry_fields():
        assert f"``{field.name}``\n    {field.text}" in FrameReport.__doc__


# On the wire and in recordings: a number never changes its meaning. New reasons come behind these.
PUBLISHED_REASONS = [
    "none",
    "no_tag_found",
    "no_tag_of_the_leader",
    "tag_refused",
    "pose_refused",
    "no_frame",
    "frame_size_not_calibrated",
    "frame_too_small",
    "frame_too_large",
    "frame_truncated",
    "frame_stride_invalid",
    "frame_time_not_advancing",
    "frame_stale",
    "stop_requested",
    "law_not_finite",
    "tag_duplicate",
    "tag_outside_frame",
    "tag_too_small",
    "tag_too_blurred",
    "tag_size_implausible",
    "leader_behind_camera",
    "leader_jumped",
    "camera_frozen",
    "frame_time_implausible",
    "another_coordinator",
    "internal_error",
    "picture_repeated",
]


def test_a_reason_keeps_its_number():
    numbers = {int(reason): name for name, reason in Reason.__members__.items()}
    assert [numbers[number] for number in range(len(PUBLISHED_REASONS))] == PUBLISHED_REASONS
    assert len({reason.text for reason in Reason.__members__.values()}) == len(numbers)
