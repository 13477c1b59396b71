"""A replay that finds a difference says where it comes from: which input, or which stage."""

from __future__ import annotations

import shutil
import struct
from pathlib import Path

import numpy as np
import pytest
from recorded_runs import RecordedRun, observation_at
from typer.testing import CliRunner

from pilotfish import core
from pilotfish.black_box import causes, events_in, replay
from pilotfish.black_box.bits import same_bits
from pilotfish.cli import app
from pilotfish.coordinator import step_values
from pilotfish.lcmtypes.pilotfish import box_start_t, observation_t, status_t, step_t

PERIOD_US = 33_333
TYPES = {"STEP": step_t, "BOX": box_start_t, "OBSERVATION": observation_t, "STATUS": status_t}


def published(run, seen, result):
    """What the program publishes of a frame, as far as a replay looks at it."""
    observation, status = observation_t(), status_t()
    observation.utime = status.utime = seen.utime
    observation.detected, observation.distance_m = True, seen.distance_m
    observation.bearing_rad, observation.heading_rad = seen.bearing_rad, seen.heading_rad
    status.status = int(result.status.value)
    values = step_values(result)
    for _, names in causes.STAGES:
        for name in names:
            setattr(status, name, values.get(name) or 0.0)
    run.message("ROBOT1_OBSERVATION", observation.encode())
    run.message("ROBOT1_STATUS", status.encode())


@pytest.fixture
def box(tmp_path):
    """Forty frames behind a leader that goes ahead slowly, under the law as published: its command follows from
    this frame and the one before."""
    run = RecordedRun(tmp_path / "box", profile="paper")
    for k in range(40):
        utime = 1_000_000 + k * PERIOD_US
        seen = observation_at(utime, 1.3 + 0.001 * k, -0.15)
        published(run, seen, run.see(utime, seen, 10_000_000 + k * PERIOD_US))
    run.flush()
    run.close()
    (file,) = (tmp_path / "box").glob("*.lcmlog")
    return file


def changed(file: Path, kind: str, number: int, change) -> Path:
    """A copy in which ``change`` was made to the message ``number`` of a kind."""
    target, seen = file.with_name("changed.lcmlog"), 0
    with target.open("wb") as stream:
        for event in events_in(file):
            data = event.data
            if event.channel.endswith(f"_{kind}"):
                if seen == number:
                    message = TYPES[kind].decode(data)
                    change(message)
                    data = message.encode()
                seen += 1
            stream.write(struct.pack(">Iqqii", 0xEDA1DA01, 0, event.utime, len(event.channel), len(data)))
            stream.write(event.channel.encode() + data)
    return target


def first(file):
    return replay(events_in(file)).first_difference


def test_an_untouched_recording_has_no_difference(box):
    report = replay(events_in(box))
    assert (report.commands, report.differences) == (40, 0)


def test_an_input_that_is_not_the_published_one_is_named_with_both_values(box):
    def farther(step):
        step.measurement[0].distance_m += 0.05

    difference = first(changed(box, "STEP", 30, farther))
    assert difference.what == "the command"
    assert difference.causes[0].startswith("the forward speed by ")
    assert difference.causes[1] == "the input: distance_m was published as 1.33 and is recorded as 1.3800000000000001"
    assert difference.causes[2].startswith("the first stage that differs is the distance error e: error_m was ")
    assert difference.agreed_before == 30


def test_a_configuration_that_is_not_the_recorded_one_shows_at_the_first_stage_that_depends_on_it(box):
    def wider(start):
        for file in start.files:
            if file.role == "config":
                file.data = bytes(file.data).replace(b"error_scale_m: 0.8", b"error_scale_m: 0.9")
                file.size = len(file.data)

    difference = first(changed(box, "BOX", 0, wider))
    # The error in metres is the same; the law's universe is another one.
    assert difference.causes[1].startswith("the first stage that differs is the output u of the fuzzy law: output was ")


def test_a_turn_rate_alone_comes_from_behind_the_law(box):
    def sharper(start):
        for file in start.files:
            if file.role == "config":
                file.data = bytes(file.data).replace(b"gain_per_s: 2.0", b"gain_per_s: 2.5")
                file.size = len(file.data)

    difference = first(changed(box, "BOX", 0, sharper))
    assert difference.causes[0].startswith("the turn rate by ")
    assert "all intermediate results of the law agree" in difference.causes[1]


def test_a_command_of_which_one_bit_was_flipped_says_by_how_much(box):
    def flip(step):
        (bits,) = struct.unpack("<q", struct.pack("<d", step.command_linear_mps))
        (step.command_linear_mps,) = struct.unpack("<d", struct.pack("<q", bits ^ 1))

    difference = first(changed(box, "STEP", 20, flip))
    assert difference.causes[0].startswith("the forward speed by ")
    assert "e-1" in difference.causes[0]  # in the last bit


def test_what_is_held_otherwise_is_named_by_its_field(box):
    def longer(step):
        step.held.until_us += 1000

    difference = first(changed(box, "STEP", 5, longer))
    assert difference.what == "what is held"
    assert difference.causes[0].startswith("until_us: ")


def test_a_published_status_that_is_damaged_does_no_harm(box):
    def nothing(status):
        status.utime = 0

    changed(box, "STATUS", 20, nothing)
    assert first(box.with_name("changed.lcmlog")) is None


def seen(**changes):
    corners = np.array([[10.0, 40.0], [40.0, 40.0], [40.0, 10.0], [10.0, 10.0]])
    tag = core.TagDetection(id=3, hamming=0, decision_margin=80.0, corners_px=corners + changes.pop("off_px", 0.0))
    values = {"distance_m": 1.0, "bearing_rad": 0.1, "heading_rad": 0.2}
    covariance = np.eye(3) * changes.pop("variance", 1e-6)
    alone = {name: changes.pop(f"alone_{name}", value) for name, value in values.items()}
    measured = core.RelativeMeasurement(**alone, covariance=covariance)
    found_by = changes.pop("found_by", core.FoundBy.track)
    return core.Observation(
        utime=5, **(values | changes), covariance=covariance, measured=measured, found_by=found_by, tags=[tag]
    )


@pytest.mark.parametrize(
    ("other", "cause"),
    [
        (None, "measured then, and is not now"),
        ({"off_px": 0.25}, "corners of the tags differ, by 0.25 px"),
        ({"found_by": core.FoundBy.frame}, "found by track then, by frame now"),
        ({"alone_heading_rad": 0.3}, "another pose: heading_rad of this frame alone"),
        ({"bearing_rad": 0.1000001}, "bearing_rad of the filter over the frames"),
        ({"variance": 2e-6}, "covariance or a figure of quality"),
    ],
)
def test_of_what_is_seen_otherwise_the_earliest_stage_is_named(other, cause):
    assert cause in causes.observation_cause(seen(), None if other is None else seen(**other))


def test_bits_are_compared_and_not_values():
    assert not same_bits(0.0, -0.0)
    assert same_bits(float("nan"), float("nan"))
    assert not same_bits(0.1 + 0.2, 0.3)


def test_the_command_line_shows_causes_and_ends_with_1(box, tmp_path):
    def farther(step):
        step.measurement[0].distance_m += 0.05

    file = changed(box, "STEP", 30, farther)
    alone = tmp_path / "alone.lcmlog"
    shutil.copy(file, alone)
    result = CliRunner().invoke(app, ["replay", str(alone), "--assert"])
    assert result.exit_code == 1
    assert "the input: distance_m was published as 1.33" in result.output
    assert "30 calls before it" in result.output
